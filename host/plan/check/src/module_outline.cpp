// SPDX-License-Identifier: GPL-3.0-or-later
#include "module_outline.hpp"

#include <algorithm>
#include <cmath>

namespace triskin::check {
namespace {

// Both distances are taken from the centre.
const double kToSide = kSide * kRoot3 / 6.0, kToCorner = kSide * kRoot3 / 3.0;

double cut_from_center(double cut) {
  return kToCorner - cut * kRoot3 / 2.0;
}

}  // namespace

Outline3 clipped(const Outline3& outline, const P3& from, const P3& direction, double limit) {
  Outline3 kept;
  for (std::size_t k = 0; k < outline.size(); ++k) {
    const P3 &a = outline[k], &b = outline[(k + 1) % outline.size()];
    const double at_a = direction.dot(a - from) - limit, at_b = direction.dot(b - from) - limit;
    if (at_a <= 0.0) kept.push_back(a);
    if ((at_a < 0.0 && at_b > 0.0) || (at_a > 0.0 && at_b < 0.0)) kept.push_back(a + at_a / (at_a - at_b) * (b - a));
  }
  return kept;
}

Outline3 module_outline(const Triangle3& corners, double cut, double inset) {
  const P3 c = centroid(corners);
  const double scale = std::max(0.0, 1.0 - inset / kToSide);
  Outline3 outline;
  for (const P3& corner : corners) outline.push_back(inset > 0.0 ? P3(c + scale * (corner - c)) : corner);
  if (!(cut > 0.0)) return outline;
  for (const P3& corner : corners)
    outline = clipped(outline, c, (corner - c).normalized(), std::max(0.0, cut_from_center(cut) - inset));
  return outline;
}

double beyond_cut(const Triangle3& corners, double cut, const P3& point) {
  const P3 c = centroid(corners);
  double most = -kToCorner;
  for (const P3& corner : corners) most = std::max(most, (corner - c).normalized().dot(point - c));
  return most - cut_from_center(cut);
}

double area_left(double cut) {
  return (kSide * kSide - 3.0 * cut * cut) * kRoot3 / 4.0;
}

}  // namespace triskin::check
