// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <array>

#include "triskin/geometry/surface.hpp"

namespace triskin::geometry {

/// The rigid module nearest to three points (Kabsch, 1976).
[[nodiscard]] std::array<Vec3, 3> fit_rigid(const std::array<Vec3, 3>& target);

/// How far the sides stand over the border and how deep they lie under the surface, walking each side in `samples` steps, finer
/// round the largest overrun.
struct SideMetrics {
  double overrun_mm = 0.0, depth_mm = 0.0;
};
[[nodiscard]] SideMetrics walk_sides(const Surface& surface, const std::array<Vec3, 3>& corners, int samples);

/// How far the module stands over the border within its sides: over a hole, or a notch that widens under it. 0 without border under it.
[[nodiscard]] double overrun_inside(const Surface& surface, const std::array<Vec3, 3>& corners);

}  // namespace triskin::geometry
