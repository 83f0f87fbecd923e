// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <array>

#include "triskin/design/outline.hpp"
#include "triskin/geometry/surface.hpp"

namespace triskin::geometry {

/// The rigid module nearest to three points (Kabsch, 1976).
[[nodiscard]] std::array<Vec3, 3> fit_rigid(const std::array<Vec3, 3>& target);

/// How far the sides of an outline lie above and under the surface along its normal, in steps of `step_mm`.
struct SideHeights {
  double lift_mm = 0.0, depth_mm = 0.0;
};
[[nodiscard]] SideHeights walk_sides(const Surface& surface, const design::Outline& outline, double step_mm);

/// Overrun of a line over the border, to 0.02 mm below; `known_mm` where none is larger. A larger `known_mm` is faster.
[[nodiscard]] double overrun_of_line(const Surface& surface, const Vec3& from, const Vec3& to, double known_mm = 0.0);
/// Overrun of a module, sides and area, to 0.02 mm below.
[[nodiscard]] double overrun_of(const Surface& surface, const design::Outline& outline);

/// Where a corner is held: the foot of `p` on the surface; past the border up to `overhang_mm` beyond it. `foot`: a
/// point of the surface near `p`, the nearer the faster; then the foot of `p`.
[[nodiscard]] Vec3 held_to_surface(const Surface& surface, const Vec3& p, double overhang_mm, Vec3& foot);

}  // namespace triskin::geometry
