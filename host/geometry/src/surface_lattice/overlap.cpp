// SPDX-License-Identifier: GPL-3.0-or-later
#include "overlap.hpp"

#include <cmath>
#include <limits>

namespace triskin::geometry::surface_lattice {
namespace {

constexpr double kReach_mm = 45.0;  // as in measure.cpp: centroids farther apart cannot touch
constexpr double kLayer_mm = 10.0;  // modules farther apart along the normal lie on different sheets
constexpr double kOpposite = -0.2;

struct Extreme {
  double low = std::numeric_limits<double>::infinity(), high = -std::numeric_limits<double>::infinity();
  int low_corner = 0, high_corner = 0;
};

Extreme along(const Triangle& t, const Vec3& axis) {
  Extreme e;
  for (int k = 0; k < 3; ++k) {
    const double d = axis.dot(t[at(k)]);
    if (d < e.low) {
      e.low = d;
      e.low_corner = k;
    }
    if (d > e.high) {
      e.high = d;
      e.high_corner = k;
    }
  }
  return e;
}

// Segment through the inside of a triangle (Möller and Trumbore, 1997).
bool passes(const Vec3& from, const Vec3& to, const Triangle& t) {
  const Vec3 d = to - from, u = t[1] - t[0], v = t[2] - t[0], p = d.cross(v);
  const double volume = u.dot(p);
  if (std::abs(volume) < 1e-12) return false;
  const Vec3 o = from - t[0], q = o.cross(u);
  const double a = o.dot(p) / volume, b = d.dot(q) / volume, along_segment = v.dot(q) / volume;
  return a > 0 && b > 0 && a + b < 1 && along_segment > 0 && along_segment < 1;
}

}  // namespace

Overlap overlap_of(const NetTriangle& a, const NetTriangle& b) {
  Overlap result;
  const Vec3 between = a.center - b.center;
  if (between.squaredNorm() > kReach_mm * kReach_mm || a.normal.dot(b.normal) < kOpposite) return result;
  const Vec3 n = (a.normal + b.normal).normalized();
  if (std::abs(n.dot(between)) > kLayer_mm) return result;
  result.depth_mm = std::numeric_limits<double>::infinity();
  for (const Triangle* t : {&a.rigid, &b.rigid}) {
    for (std::size_t k = 0; k < 3; ++k) {
      const Vec3 axis = ((*t)[(k + 1) % 3] - (*t)[k]).cross(n).normalized();
      const Extreme ea = along(a.rigid, axis), eb = along(b.rigid, axis);
      if (ea.high <= eb.low || eb.high <= ea.low) return {};
      if (ea.high - eb.low < result.depth_mm) result = {ea.high - eb.low, axis, ea.high_corner, eb.low_corner};
      if (eb.high - ea.low < result.depth_mm) result = {eb.high - ea.low, -axis, ea.low_corner, eb.high_corner};
    }
  }
  return result;
}

bool pierced(const NetTriangle& a, const NetTriangle& b, double allowed_mm) {
  constexpr double kInradius_mm = kHeight_mm / 3.0;
  if ((a.center - b.center).norm() > 4.0 * kInradius_mm) return false;
  const double scale = 1.0 - allowed_mm / kInradius_mm;
  Triangle p, q;
  for (std::size_t k = 0; k < 3; ++k) {
    p[k] = a.center + scale * (a.rigid[k] - a.center);
    q[k] = b.center + scale * (b.rigid[k] - b.center);
  }
  for (std::size_t k = 0; k < 3; ++k) {
    if (passes(p[k], p[(k + 1) % 3], q) || passes(q[k], q[(k + 1) % 3], p)) return true;
  }
  return false;
}

}  // namespace triskin::geometry::surface_lattice
