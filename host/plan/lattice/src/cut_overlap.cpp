// SPDX-License-Identifier: GPL-3.0-or-later
#include "cut_overlap.hpp"

#include <algorithm>
#include <limits>

#include "triskin/design/outline.hpp"

namespace triskin::lattice {
namespace {

using design::Outline;

// Point 2k of an outline lies near corner k, point 2k + 1 near the next one.
int corner_of(std::size_t point) {
  return static_cast<int>((point + 1) / 2 % 3);
}

std::size_t deepest_along(const Outline& o, const Vec3& out) {
  std::size_t deepest = 0;
  for (std::size_t k = 1; k < o.size; ++k) {
    if (out.dot(o.point[k]) < out.dot(o.point[deepest])) deepest = k;
  }
  return deepest;
}

// Returns true if a segment passes through the inside of a flat outline with this normal, like `passes` of overlap.cpp
// for triangles.
bool passes(const Vec3& from, const Vec3& to, const Outline& o, const Vec3& normal) {
  const double below = normal.dot(o.point[0] - from), above = normal.dot(to - o.point[0]);
  if ((below > 0) != (above > 0) || below == 0 || above == 0) return false;
  const Vec3 crossing = (above * from + below * to) / (above + below);
  for (std::size_t k = 0; k < o.size; ++k) {
    if (normal.dot((o.point[(k + 1) % o.size] - o.point[k]).cross(crossing - o.point[k])) <= 0) return false;
  }
  return true;
}

}  // namespace

Overlap overlap_of_cut(const NetTriangle& a, const NetTriangle& b) {
  const std::array<Outline, 2> outline{design::outline_of(a.rigid, a.corner_cut_mm),
                                       design::outline_of(b.rigid, b.corner_cut_mm)};
  const Vec3 n = a.normal + b.normal;
  double least = std::numeric_limits<double>::infinity();
  Overlap result;
  for (std::size_t of = 0; of < 2; ++of) {
    const Outline &o = outline[of], &other = outline[1 - of];
    for (std::size_t from = 0; from < o.size; ++from) {
      const std::size_t to = (from + 1) % o.size;
      const Vec3 along = o.point[to] - o.point[from], out = along.cross(n);
      const std::size_t deepest = deepest_along(other, out);
      const double length = out.norm(), inside = out.dot(o.point[from] - other.point[deepest]) / length;
      if (inside <= 0.0) return {};
      if (inside >= least) continue;
      least = inside;
      const bool near_end = (2.0 * other.point[deepest] - o.point[from] - o.point[to]).dot(along) > 0.0;
      const int own = corner_of(near_end ? to : from), others = corner_of(deepest);
      result = of == 0 ? Overlap{least, out / length, own, others} : Overlap{least, -out / length, others, own};
    }
  }
  return result;
}

bool pierced_cut(const Triangle& a, const Triangle& b, double corner_cut_mm, double allowed_mm) {
  const Outline p = design::inset_outline(a, corner_cut_mm, allowed_mm),
                q = design::inset_outline(b, corner_cut_mm, allowed_mm);
  const auto any_side_passes = [](const Outline& from, const Outline& through, const Vec3& normal) {
    for (std::size_t k = 0; k < from.size; ++k) {
      if (passes(from.point[k], from.point[(k + 1) % from.size], through, normal)) return true;
    }
    return false;
  };
  const auto normal_of = [](const Triangle& t) { return (t[1] - t[0]).cross(t[2] - t[0]); };
  return any_side_passes(p, q, normal_of(b)) || any_side_passes(q, p, normal_of(a));
}

}  // namespace triskin::lattice
