// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <array>

#include "triskin/design/outline.hpp"
#include "triskin/mesh/surface.hpp"

namespace triskin::lattice {

/// Returns the rigid module nearest to three points (Kabsch, 1976).
[[nodiscard]] std::array<Vec3, 3> fit_rigid(const std::array<Vec3, 3>& target);

/// Measures how far the sides of an outline lie above and below the surface along its normal, in steps of `step_mm`.
struct SideHeights {
  double lift_mm = 0.0, depth_mm = 0.0;
};
[[nodiscard]] SideHeights walk_sides(const mesh::Surface& surface, const design::Outline& outline, double step_mm);

/// Returns the position at which a corner is held: the foot of `p` on the surface; past the border up to `overhang_mm`
/// beyond it. `foot` is a point of the surface near `p` (a nearer one is faster) and receives the foot of `p`.
[[nodiscard]] Vec3 held_to_surface(const mesh::Surface& surface, const Vec3& p, double overhang_mm, Vec3& foot);

}  // namespace triskin::lattice
