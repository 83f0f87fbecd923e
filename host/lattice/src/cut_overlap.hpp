// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "triskin/lattice/overlap.hpp"

namespace triskin::geometry::surface_lattice {

/// overlap_of() for modules with cut corners, whose whole triangles overlap (else they do not either). Its corners are
/// those of the triangles that are nearest to the points of the outlines that touch.
[[nodiscard]] Overlap overlap_of_cut(const NetTriangle& a, const NetTriangle& b);

/// pierced() for modules with cut corners, which are near each other; the limit is below their inner radius.
[[nodiscard]] bool pierced_cut(const Triangle& a, const Triangle& b, double corner_cut_mm, double allowed_mm);

}  // namespace triskin::geometry::surface_lattice
