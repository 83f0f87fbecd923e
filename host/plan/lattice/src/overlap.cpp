// SPDX-License-Identifier: GPL-3.0-or-later
#include "overlap.hpp"

#include <cmath>
#include <limits>

#include "body_overlap.hpp"
#include "cut_overlap.hpp"

namespace triskin::lattice {
namespace {

constexpr double kLayer_mm = 10.0;  // Modules farther apart along the normal lie on different sheets.

// Returns true if a segment passes through the inside of a triangle: its ends lie on different sides of the plane, and
// the point between them, in the ratio of their distances, lies left of every side. On flat faces the distances are
// rounding alone; the point then still lies on the segment, and modules that are shrunk from each other stay apart
// there.
bool passes(const Vec3& from, const Vec3& to, const Triangle& t) {
  const Vec3 normal = (t[1] - t[0]).cross(t[2] - t[0]);
  const double below = normal.dot(t[0] - from), above = normal.dot(to - t[0]);
  if ((below > 0) != (above > 0) || below == 0 || above == 0) return false;
  const Vec3 crossing = (above * from + below * to) / (above + below);
  for (std::size_t k = 0; k < 3; ++k) {
    const Vec3 side = t[(k + 1) % 3] - t[k];
    if (normal.dot(side.cross(crossing - t[k])) <= 0) return false;
  }
  return true;
}

// Two convex outlines are apart when all of one lies beyond a side of the other, and the least motion that separates
// them is normal to a side, so only outward directions have to be tried. Nothing is normalized before it is known that
// they overlap.
Overlap overlap_of_triangles(const NetTriangle& a, const NetTriangle& b, int& first_axis) {
  Overlap result;
  const Vec3 between = a.center - b.center;
  if (const double squared = between.squaredNorm(); squared > kApart_mm * kApart_mm) {
    result.apart_mm = std::sqrt(squared) - kApart_mm;
    return result;
  }
  if (a.normal.dot(b.normal) < kBodiesBelow) return result;
  const Vec3 n = a.normal + b.normal;
  const double layer = n.dot(between);
  if (layer * layer > kLayer_mm * kLayer_mm * n.squaredNorm()) return result;
  double least = std::numeric_limits<double>::infinity();
  for (int k = 0, side = first_axis; k < 6; ++k, side = side == 5 ? 0 : side + 1) {
    const bool of_a = side < 3;
    const int from = of_a ? side : side - 3, to = from == 2 ? 0 : from + 1;
    const Triangle &t = of_a ? a.rigid : b.rigid, &other = of_a ? b.rigid : a.rigid;
    const Vec3 along = t[at(to)] - t[at(from)], out = along.cross(n);
    const std::array<double, 3> d{out.dot(other[0]), out.dot(other[1]), out.dot(other[2])};
    const int deepest = d[0] < d[1] ? (d[0] < d[2] ? 0 : 2) : (d[1] < d[2] ? 1 : 2);
    const double inside = out.dot(t[at(from)]) - d[at(deepest)];
    if (inside <= 0.0) {
      constexpr double kLongest_mm = 2.0 * kSide_mm;  // A side times two unit normals.
      first_axis = side;
      result = {};
      result.apart_mm = -inside / kLongest_mm;
      return result;
    }
    const double length = out.norm();
    if (inside >= least * length) continue;
    least = inside / length;
    const bool near_end = (2.0 * other[at(deepest)] - t[at(from)] - t[at(to)]).dot(along) > 0.0;
    const int corner = near_end ? to : from;
    result =
        of_a ? Overlap{least, out / length, corner, deepest, 0.0} : Overlap{least, -out / length, deepest, corner, 0.0};
  }
  return result;
}

}  // namespace

Overlap overlap_of(const NetTriangle& a, const NetTriangle& b, int& first_axis) {
  const Overlap whole = overlap_of_triangles(a, b, first_axis);
  return a.corner_cut_mm > 0.0 && whole.depth_mm > 0.0 ? overlap_of_cut(a, b) : whole;
}

Overlap overlap_of(const NetTriangle& a, const NetTriangle& b) {
  int axis = 0;
  return overlap_of(a, b, axis);
}

bool pierced(const Triangle& a, const Triangle& b, double corner_cut_mm, double allowed_mm) {
  constexpr double kInradius_mm = kHeight_mm / 3.0;
  const Vec3 center_a = (a[0] + a[1] + a[2]) / 3.0, center_b = (b[0] + b[1] + b[2]) / 3.0;
  if ((center_a - center_b).norm() > 4.0 * kInradius_mm || allowed_mm >= kInradius_mm) return false;
  if (corner_cut_mm > 0.0) return pierced_cut(a, b, corner_cut_mm, allowed_mm);
  const double scale = 1.0 - allowed_mm / kInradius_mm;
  Triangle p, q;
  for (std::size_t k = 0; k < 3; ++k) {
    p[k] = center_a + scale * (a[k] - center_a);
    q[k] = center_b + scale * (b[k] - center_b);
  }
  for (std::size_t k = 0; k < 3; ++k) {
    if (passes(p[k], p[(k + 1) % 3], q) || passes(q[k], q[(k + 1) % 3], p)) return true;
  }
  return false;
}

}  // namespace triskin::lattice
