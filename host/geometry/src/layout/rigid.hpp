// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <array>

#include "triskin/design/outline.hpp"
#include "triskin/geometry/surface.hpp"

namespace triskin::geometry {

/// The rigid module nearest to three points (Kabsch, 1976).
[[nodiscard]] std::array<Vec3, 3> fit_rigid(const std::array<Vec3, 3>& target);

/// Overrun of the sides of an outline over the border, to 0.02 mm below, and how far they lie above and under the
/// surface along its normal, in steps of `step_mm`.
struct SideMetrics {
  double overrun_mm = 0.0, lift_mm = 0.0, depth_mm = 0.0;
};
[[nodiscard]] SideMetrics walk_sides(const Surface& surface, const design::Outline& outline, double step_mm);

/// Overrun of the whole module over the border, to 0.02 mm below; never less than `known_mm` of its sides.
[[nodiscard]] double overrun_of_area(const Surface& surface, const design::Outline& outline, double known_mm);

/// Where a corner is held: the foot of `p` on the surface; past the border up to `overhang_mm` beyond it.
[[nodiscard]] Vec3 held_to_surface(const Surface& surface, const Vec3& p, double overhang_mm);

}  // namespace triskin::geometry
