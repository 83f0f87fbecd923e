// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <array>
#include <vector>

#include "ray_caster.hpp"

namespace triskin::geometry {

/// Each region is a set of faces that are connected over smooth edges on one side of the wall.
struct SmoothRegions {
  std::vector<int> of_face;  ///< Components are numbered from 0 to count − 1.
  int count = 0;
};

/// Divides a part into regions. Faces with a wall behind them are connected over smooth edges. From there a region
/// grows over smooth edges to faces without a wall (above a rib, on a fillet) as long as they turn little from where it
/// started, so that it ends half-way round a rounded rim; the remaining faces form regions of their own. Deterministic.
/// Cost: O(n log n).
[[nodiscard]] SmoothRegions smooth_regions(const RayCaster& part, const std::vector<std::array<int, 3>>& neighbours,
                                           const std::vector<double>& walled_fractions);

}  // namespace triskin::geometry
