// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstddef>
#include <vector>

#include "kernels/pair_kernel.hpp"
#include "kernels/tile_grid.hpp"
#include "kernels/tile_polygon.hpp"

namespace triskin::placement {

/// The edges near a tile are looked up within this distance; the children of a slice move less.
inline constexpr double kSliceReach_mm = 9.0;

/// This many slices have their most promising motion tried before any is divided.
inline constexpr std::size_t kTriedSlices = 16;

/// Returns how far from its centre a tile's edges may cut it in a child of a slice, if a tile is decided only when it
/// keeps `certain_mm`.
[[nodiscard]] double slice_child_reach_mm(const PreparedPolygon& polygon, const TileGrid& grid, const MotionBox& box,
                                          double certain_mm);

/// Returns the part of the inradius of a tile that stays inside the outline if the tile may overhang it by -inset_mm;
/// 1 if inset_mm ≥ 0.
[[nodiscard]] double kept_inradius(const TileGrid& grid, double inset_mm);

/// Divides all motions into slices by their angle, the largest angles first. A slice has all translations of one
/// lattice period, because constraints are almost linear in x and y, so that SliceRaster can cut it finely at once.
[[nodiscard]] std::vector<MotionBox> slices_of(const PreparedPolygon& polygon, const TileGrid& grid, double inset_mm);

}  // namespace triskin::placement
