// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <vector>

#include "triskin/base/index.hpp"
#include "triskin/design/fold.hpp"
#include "triskin/design/module.hpp"

namespace triskin::lattice {

using design::normal_of;

/// Returns the largest angle of a joint between modules with these unit normals; `along` is that of folds_away().
[[nodiscard]] inline double fold_limit_between(const design::LayoutLimits& limits, const design::Vec3& normal,
                                               const design::Vec3& other_normal, const design::Vec3& along) {
  return design::fold_limit_rad(limits, design::folds_away(normal, other_normal, along));
}

/// Returns the largest angle of the joint across side `s` of a module that has a neighbour there.
[[nodiscard]] inline double fold_limit_of(const design::LayoutLimits& limits,
                                          const std::vector<design::PlacedModule>& modules,
                                          const design::PlacedModule& m, int s) {
  const design::PlacedModule& other = modules[at(m.neighbour[at(s)])];
  return fold_limit_between(limits, normal_of(m.corner_mm), normal_of(other.corner_mm),
                            m.corner_mm[at((s + 1) % 3)] - m.corner_mm[at(s)]);
}

}  // namespace triskin::lattice
