// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "net.hpp"

namespace triskin::geometry::surface_lattice {

/// Depth by which two rigid modules lie over each other, and the motion that reduces it: corner `corner_a` of a against
/// corner `corner_b` of b along `axis` (unit): depth = axis · (a[corner_a] − b[corner_b]).
struct Overlap {
  double depth_mm = 0.0;
  Vec3 axis = Vec3::Zero();
  int corner_a = 0, corner_b = 0;
};

/// Separating axes in the mean plane, as `penetration_depth` of map_modules.hpp defines it.
[[nodiscard]] Overlap overlap_of(const NetTriangle& a, const NetTriangle& b);

/// True when two modules, each shrunk by `allowed_mm` on all sides, pass through each other in space.
[[nodiscard]] bool pierced(const NetTriangle& a, const NetTriangle& b, double allowed_mm);

}  // namespace triskin::geometry::surface_lattice
