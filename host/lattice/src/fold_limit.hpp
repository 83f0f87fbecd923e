// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <array>
#include <vector>

#include "triskin/base/index.hpp"
#include "triskin/design/module.hpp"

namespace triskin::geometry {

/// Returns the unit normal of a module, which points away from the surface.
[[nodiscard]] inline design::Vec3 normal_of(const std::array<design::Vec3, 3>& corners) {
  return (corners[1] - corners[0]).cross(corners[2] - corners[0]).normalized();
}

/// Returns the largest angle of a joint between modules with these unit normals. `along` runs along the joint,
/// counter-clockwise around the first module, and tells whether they fold away from the touch side or towards it.
[[nodiscard]] inline double fold_limit_between(const design::LayoutLimits& limits, const design::Vec3& normal,
                                               const design::Vec3& other_normal, const design::Vec3& along) {
  return design::fold_limit_rad(limits, normal.cross(other_normal).dot(along) >= 0.0);
}

/// Returns the largest angle of the joint across side `s` of a module that has a neighbour there.
[[nodiscard]] inline double fold_limit_of(const design::LayoutLimits& limits,
                                          const std::vector<design::PlacedModule>& modules,
                                          const design::PlacedModule& m, int s) {
  const design::PlacedModule& other = modules[at(m.neighbour[at(s)])];
  return fold_limit_between(limits, normal_of(m.corner_mm), normal_of(other.corner_mm),
                            m.corner_mm[at((s + 1) % 3)] - m.corner_mm[at(s)]);
}

}  // namespace triskin::geometry
