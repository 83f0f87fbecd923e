// SPDX-License-Identifier: GPL-3.0-or-later
#include "overlap.hpp"

#include <cmath>
#include <limits>

namespace triskin::geometry::surface_lattice {
namespace {

constexpr double kApart_mm = 4.0 * kHeight_mm / 3.0;  // two circumradii: centroids farther apart cannot touch
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

Overlap overlap_of(const NetTriangle& a, const NetTriangle& b, int& first_axis) {
  Overlap result;
  const Vec3 between = a.center - b.center;
  if (between.squaredNorm() > kApart_mm * kApart_mm || a.normal.dot(b.normal) < kOpposite) return result;
  const Vec3 n = (a.normal + b.normal).normalized();
  if (std::abs(n.dot(between)) > kLayer_mm) return result;
  double least = std::numeric_limits<double>::infinity();
  for (int k = 0, side = first_axis; k < 6; ++k, side = side == 5 ? 0 : side + 1) {
    const Triangle& t = side < 3 ? a.rigid : b.rigid;
    const Vec3 axis = (t[at((side + 1) % 3)] - t[at(side % 3)]).cross(n);
    const Extreme ea = along(a.rigid, axis), eb = along(b.rigid, axis);
    if (ea.high <= eb.low || eb.high <= ea.low) {
      first_axis = side;
      return {};
    }
    const double length = axis.norm();
    if (ea.high - eb.low < least * length) {
      least = (ea.high - eb.low) / length;
      result = {least, axis / length, ea.high_corner, eb.low_corner};
    }
    if (eb.high - ea.low < least * length) {
      least = (eb.high - ea.low) / length;
      result = {least, -axis / length, ea.low_corner, eb.high_corner};
    }
  }
  return result;
}

Overlap overlap_of(const NetTriangle& a, const NetTriangle& b) {
  int axis = 0;
  return overlap_of(a, b, axis);
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
