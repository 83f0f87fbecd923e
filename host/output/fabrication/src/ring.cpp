// SPDX-License-Identifier: GPL-3.0-or-later
#include "ring.hpp"

#include <algorithm>
#include <cmath>

namespace triskin::fabrication {

using design::Vec2;

Vec2 rotated(const Vec2& p, double angle_rad) {
  const double c = std::cos(angle_rad), s = std::sin(angle_rad);
  return {c * p.x() - s * p.y(), s * p.x() + c * p.y()};
}

double area_within(const Ring& ring) {
  double twice = 0.0;
  for (std::size_t k = 0; k < ring.size(); ++k) {
    const Vec2 &a = ring[k], &b = ring[(k + 1) % ring.size()];
    twice += a.x() * b.y() - a.y() * b.x();
  }
  return 0.5 * twice;
}

}  // namespace triskin::fabrication
