// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <array>

#include "triskin/design/mesh.hpp"

/// How two joined modules are turned against each other.
namespace triskin::design {

/// Returns the unit normal of a module, which points away from the surface.
[[nodiscard]] inline Vec3 normal_of(const std::array<Vec3, 3>& corners) {
  return (corners[1] - corners[0]).cross(corners[2] - corners[0]).normalized();
}

/// Returns true if joined modules with these normals fold away from the touch side, as over a ridge, or lie in one
/// plane; false if they fold towards it. `along` runs along the joint, counter-clockwise around the first module.
[[nodiscard]] inline bool folds_away(const Vec3& normal, const Vec3& other_normal, const Vec3& along) {
  return normal.cross(other_normal).dot(along) >= 0.0;
}

}  // namespace triskin::design
