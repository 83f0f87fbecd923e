// SPDX-License-Identifier: GPL-3.0-or-later
#include "body_overlap.hpp"

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Surface_mesh.h>
#include <CGAL/convex_hull_3.h>

#include <algorithm>
#include <limits>
#include <vector>

#include "module_outline.hpp"

namespace triskin::check {
namespace {

using HullKernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Hull = CGAL::Surface_mesh<HullKernel::Point_3>;

constexpr double kNear_mm = 45.0;    // Two circumradii and the height; modules farther apart cannot touch.
constexpr double kApart_mm = 10.0;   // Sheets farther apart lie over each other.
constexpr double kFacesAway = -0.2;  // Below this cosine of the normals modules are compared as bodies.
constexpr double kBody_mm = 2.0;     // The soft layer.
// A triangle of the hull whose height is a smaller part of its longest side has no normal to speak of. What it covers
// of a face, better triangles cover too.
constexpr double kSliver = 1e-7;

// Returns the overlap of two convex outlines: the least distance that separates them, over the directions of their
// sides.
double planar_overlap(const std::vector<P2>& a, const std::vector<P2>& b) {
  double least = std::numeric_limits<double>::infinity();
  const auto range_of = [](const std::vector<P2>& t, const P2& n) {
    std::array<double, 2> range{1e300, -1e300};
    for (const P2& p : t) range = {std::min(range[0], p.dot(n)), std::max(range[1], p.dot(n))};
    return range;
  };
  const auto test = [&](const std::vector<P2>& t) {
    for (std::size_t k = 0; k < t.size(); ++k) {
      const P2 e = t[(k + 1) % t.size()] - t[k];
      const P2 n = P2(-e.y(), e.x()) / e.norm();
      const auto of_a = range_of(a, n), of_b = range_of(b, n);
      least = std::min({least, of_a[1] - of_b[0], of_b[1] - of_a[0]});
    }
  };
  test(a);
  test(b);
  return std::max(0.0, least);
}

// Seen along the mean of their normals, within one layer.
double side_by_side(const Triangle3& a, const Triangle3& b, double cut) {
  const P3 n = (unit_normal(a) + unit_normal(b)).normalized();
  if (std::abs((centroid(b) - centroid(a)).dot(n)) > kApart_mm) return 0.0;
  const P3 x = n.unitOrthogonal(), y = n.cross(x);
  const auto flat = [&](const Triangle3& t) {
    std::vector<P2> points;
    for (const P3& p : module_outline(t, cut)) points.emplace_back(p.dot(x), p.dot(y));
    return points;
  };
  return planar_overlap(flat(a), flat(b));
}

std::vector<P3> body_of(const Triangle3& t, double cut) {
  std::vector<P3> points = module_outline(t, cut);
  const std::size_t count = points.size();
  for (std::size_t k = 0; k < count; ++k) points.push_back(points[k] + kBody_mm * unit_normal(t));
  return points;
}

// The bodies overlap if the origin lies in the set of all differences of their points, and its distance from the border
// of that set is the shortest way apart.
double as_bodies(const Triangle3& a, const Triangle3& b, double cut) {
  std::vector<HullKernel::Point_3> differences;
  for (const P3& p : body_of(a, cut)) {
    for (const P3& q : body_of(b, cut)) differences.emplace_back(p.x() - q.x(), p.y() - q.y(), p.z() - q.z());
  }
  Hull hull;
  CGAL::convex_hull_3(differences.begin(), differences.end(), hull);
  double least = std::numeric_limits<double>::infinity();
  for (const auto face : hull.faces()) {
    std::vector<P3> corner;
    for (const auto v : hull.vertices_around_face(hull.halfedge(face)))
      corner.emplace_back(hull.point(v).x(), hull.point(v).y(), hull.point(v).z());
    const P3 out = (corner[1] - corner[0]).cross(corner[2] - corner[0]);
    double longest = 0.0;
    for (std::size_t k = 0; k < 3; ++k) longest = std::max(longest, (corner[(k + 1) % 3] - corner[k]).squaredNorm());
    if (out.norm() <= kSliver * longest) continue;
    least = std::min(least, out.dot(corner[0]) / out.norm());
  }
  return std::max(0.0, least);
}

}  // namespace

double module_overlap(const Triangle3& a, const Triangle3& b, double cut) {
  if ((centroid(b) - centroid(a)).norm() > kNear_mm) return 0.0;
  return unit_normal(a).dot(unit_normal(b)) < kFacesAway ? as_bodies(a, b, cut) : side_by_side(a, b, cut);
}

}  // namespace triskin::check
