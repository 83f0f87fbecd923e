// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cmath>

#include "triskin/design/design_types.hpp"

namespace triskin::routing {

/// A free side of a module with the values that the rules of jumpers need.
struct FreeSide {
  Vec3 middle;
  Vec3 outward;  ///< The vector leads from the module's centroid to the middle of the side.
  Vec3 normal;
};

[[nodiscard]] inline FreeSide free_side(const std::array<Vec3, 3>& corner, std::size_t side) {
  const Vec3 center = (corner[0] + corner[1] + corner[2]) / 3.0;
  const Vec3 middle = 0.5 * (corner[side] + corner[(side + 1) % 3]);
  return {middle, middle - center, (corner[1] - corner[0]).cross(corner[2] - corner[0]).normalized()};
}

/// Returns true if the outward directions are more than 120° apart and each side lies before the other (by more than
/// the 0.5 mm that modules may overlap).
[[nodiscard]] inline bool face_each_other(const FreeSide& a, const FreeSide& b) {
  constexpr double kBehind_mm = 0.5;
  const double na = a.outward.norm(), nb = b.outward.norm();
  if (a.outward.dot(b.outward) >= -0.5 * na * nb) return false;
  const Vec3 d = b.middle - a.middle;
  return d.dot(a.outward) >= -kBehind_mm * na && -d.dot(b.outward) >= -kBehind_mm * nb;
}

[[nodiscard]] inline double fold_between(const FreeSide& a, const FreeSide& b) {
  return std::atan2(a.normal.cross(b.normal).norm(), a.normal.dot(b.normal));
}

}  // namespace triskin::routing
