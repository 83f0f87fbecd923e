// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <array>
#include <vector>

#include "ray_caster.hpp"
#include "wall.hpp"

namespace triskin::mesh {

/// Tells whether no module fits on a region of this area and border: it is narrower than the circle in a module.
[[nodiscard]] constexpr bool is_narrow(double area_mm2, double border_mm) {
  constexpr double kModuleInradius_mm = 8.66;
  return 2.0 * area_mm2 < kModuleInradius_mm * border_mm;
}

/// Each region is a set of faces that are connected over smooth edges on one side of the wall.
struct SmoothRegions {
  std::vector<int> of_face;  ///< Components are numbered from 0 to count − 1.
  int count = 0;
};

/// Divides a part into regions. Faces with a wall behind them are connected over smooth edges. From there a region
/// grows over smooth edges to faces without a wall (above a rib, on a fillet) as long as they turn little from where it
/// started, so that it ends half-way round a rounded rim; the remaining faces form regions of their own. Where most of
/// the wall then lies between faces of one region, as on a part whose surface turns into the rim by small steps, edges
/// count as smooth up to 20° only, unless narrow strips are all that comes of it, as of a rod. Deterministic.
/// Cost: O(n log n).
[[nodiscard]] SmoothRegions smooth_regions(const RayCaster& part,
                                           const std::vector<std::array<FaceIndex, 3>>& neighbours,
                                           const std::vector<WallSample>& samples);

}  // namespace triskin::mesh
