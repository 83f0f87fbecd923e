// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <array>
#include <vector>

#include "ray_caster.hpp"

namespace triskin::geometry {

/// Faces that hang together over smooth edges on one side of the wall.
struct SmoothRegions {
  std::vector<int> of_face;  ///< Components are numbered from 0 to count − 1.
  int count = 0;
};

/// Divides a part. Faces with a wall behind them hang together over smooth edges. From there a region grows over smooth
/// edges to faces without a wall (above a rib, on a fillet) as long as they turn little from where it came, so that it
/// ends half-way round a rounded rim; what it does not reach are regions of their own. Deterministic. Cost: O(n log n).
[[nodiscard]] SmoothRegions smooth_regions(const RayCaster& part, const std::vector<std::array<int, 3>>& neighbours,
                                           const std::vector<double>& walled_fractions);

}  // namespace triskin::geometry
