// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <limits>

#include "triskin/design/design_types.hpp"

namespace triskin::lattice {

/// Returns how far two computations of a point near a place may differ: a point of a triangle is a sum of three rounded
/// products and two sums of its coordinates, in each of three directions; 3.6e-7 mm at 1e8 mm from the origin.
[[nodiscard]] inline double rounding_mm(const Vec3& place) {
  return 16.0 * std::numeric_limits<double>::epsilon() * place.cwiseAbs().maxCoeff();
}

/// Returns a bound for searches of closest points that contains the distance itself, for distances in mm between points
/// near a place.
[[nodiscard]] inline double search_bound(double distance_mm, const Vec3& place) {
  return (1.0 + 1e-9) * distance_mm + 1e-9 + rounding_mm(place);
}

}  // namespace triskin::lattice
