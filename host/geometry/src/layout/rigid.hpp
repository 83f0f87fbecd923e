// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <array>

#include "triskin/geometry/surface.hpp"

namespace triskin::geometry {

/// The rigid module nearest to three points (Kabsch, 1976).
[[nodiscard]] std::array<Vec3, 3> fit_rigid(const std::array<Vec3, 3>& target);

/// Overrun of the sides over the border, to 0.02 mm below, and their depth under the surface, in `samples`
/// steps a side.
struct SideMetrics {
  double overrun_mm = 0.0, depth_mm = 0.0;
};
[[nodiscard]] SideMetrics walk_sides(const Surface& surface, const std::array<Vec3, 3>& corners, int samples);

/// Overrun of the whole module over the border, to 0.02 mm below; never less than `known_mm` of its sides.
[[nodiscard]] double overrun_of_area(const Surface& surface, const std::array<Vec3, 3>& corners, double known_mm);

}  // namespace triskin::geometry
