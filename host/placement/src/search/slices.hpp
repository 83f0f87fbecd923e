// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <vector>

#include "triskin/placement/kernels/pair_kernel.hpp"
#include "triskin/placement/kernels/tile_grid.hpp"
#include "triskin/placement/kernels/tile_polygon.hpp"

namespace triskin::geometry {

/// The edges near a tile are looked up within this distance; the children of a slice move less.
inline constexpr double kSliceReach_mm = 9.0;

/// Returns the part of the inradius of a tile that stays inside the outline if the tile may overhang it by -inset_mm;
/// 1 if inset_mm ≥ 0.
[[nodiscard]] double kept_inradius(const TileGrid& grid, double inset_mm);

/// Divides all motions into slices by their angle, the largest angles first. A slice has all translations of one
/// lattice period, because constraints are almost linear in x and y, so that SliceRaster can cut it finely at once.
[[nodiscard]] std::vector<MotionBox> slices_of(const PreparedPolygon& polygon, const TileGrid& grid, double inset_mm);

}  // namespace triskin::geometry
