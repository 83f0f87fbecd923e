// SPDX-License-Identifier: GPL-3.0-or-later
#include "triskin/geometry/triangle.hpp"

#include <limits>

#include "triskin/geometry/segment.hpp"

namespace triskin::geometry {
namespace {

using Eigen::Vector3d;

// Where rounding leaves a needle no inside, the nearest of its sides is the answer.
Vector3d closest_on_sides(const Vector3d& p, const Triangle& t) {
  Vector3d best = Vector3d::UnitX();
  double nearest_squared = std::numeric_limits<double>::infinity();
  for (Eigen::Index k = 0; k < 3; ++k) {
    const Vector3d &a = t[static_cast<std::size_t>(k)], &b = t[static_cast<std::size_t>((k + 1) % 3)];
    const double part = part_of_segment(p, a, b), squared = (a + part * (b - a) - p).squaredNorm();
    if (!(squared < nearest_squared)) continue;
    nearest_squared = squared;
    best = Vector3d::Zero();
    best[k] = 1.0 - part;
    best[(k + 1) % 3] = part;
  }
  return best;
}

}  // namespace

// Tests the Voronoi regions of the triangle's corners and sides.
Vector3d closest_on_triangle(const Vector3d& p, const Vector3d& a, const Vector3d& b, const Vector3d& c) {
  const Vector3d ab = b - a, ac = c - a, ap = p - a;
  const double d1 = ab.dot(ap), d2 = ac.dot(ap);
  if (d1 <= 0.0 && d2 <= 0.0) return {1, 0, 0};
  const Vector3d bp = p - b;
  const double d3 = ab.dot(bp), d4 = ac.dot(bp);
  if (d3 >= 0.0 && d4 <= d3 && d1 > d3) return {0, 1, 0};
  const double vc = d1 * d4 - d3 * d2;
  if (vc <= 0.0 && d1 >= 0.0 && d3 <= 0.0 && d1 > d3) {
    const double v = d1 / (d1 - d3);
    return {1 - v, v, 0};
  }
  const Vector3d cp = p - c;
  const double d5 = ab.dot(cp), d6 = ac.dot(cp);
  if (d6 >= 0.0 && d5 <= d6) return {0, 0, 1};
  const double vb = d5 * d2 - d1 * d6;
  if (vb <= 0.0 && d2 >= 0.0 && d6 <= 0.0 && d2 > d6) {
    const double w = d2 / (d2 - d6);
    return {1 - w, 0, w};
  }
  const double va = d3 * d6 - d5 * d4, from_b = d4 - d3, from_c = d5 - d6;
  if (va <= 0.0 && from_b >= 0.0 && from_c >= 0.0 && from_b + from_c > 0.0) {
    const double w = from_b / (from_b + from_c);
    return {0, 1 - w, w};
  }
  if (!(va > 0.0 && vb > 0.0 && vc > 0.0)) return closest_on_sides(p, {a, b, c});
  const double sum = va + vb + vc;
  return {va / sum, vb / sum, vc / sum};
}

Vector3d closest_point_on_triangle(const Vector3d& p, const Triangle& t) {
  const Vector3d w = closest_on_triangle(p, t[0], t[1], t[2]);
  return w[0] * t[0] + w[1] * t[1] + w[2] * t[2];
}

double distance_to_triangle(const Vector3d& p, const Triangle& t) {
  return (closest_point_on_triangle(p, t) - p).norm();
}

}  // namespace triskin::geometry
