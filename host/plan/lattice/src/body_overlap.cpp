// SPDX-License-Identifier: GPL-3.0-or-later
#include "body_overlap.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "triskin/design/fold.hpp"
#include "triskin/design/outline.hpp"

namespace triskin::lattice {
namespace {

// The dielectric alone, the part of a module's height that every module has (docs/mechanics.md).
constexpr double kBody_mm = 2.0;
// Directions of edges with a smaller sine are parallel; the faces between them give the axis.
constexpr double kParallel = 1e-6;

struct Body {
  std::vector<Vec3> points;  // The outline, then its copy on top.
  std::vector<Vec3> edges;   // Directions, unit; the last is the normal.
  std::vector<Vec3> faces;   // Normals, unit.
};

Body body_of(const std::array<Vec3, 3>& corners, double corner_cut_mm) {
  const design::Outline outline = design::outline_of(corners, corner_cut_mm);
  const Vec3 normal = design::normal_of(corners);
  Body body;
  for (std::size_t k = 0; k < outline.size; ++k) {
    body.points.push_back(outline.point[k]);
    body.edges.emplace_back((outline.point[(k + 1) % outline.size] - outline.point[k]).normalized());
    body.faces.push_back(body.edges.back().cross(normal));
  }
  for (std::size_t k = 0; k < outline.size; ++k) body.points.emplace_back(outline.point[k] + kBody_mm * normal);
  body.edges.push_back(normal);
  body.faces.push_back(normal);
  return body;
}

// Returns how far one of two bodies must move along a unit axis, either way, until a plane across it separates them.
double overlap_along(const Vec3& axis, const Body& a, const Body& b) {
  const auto range = [&](const Body& body) {
    const auto [low, high] = std::ranges::minmax(body.points, {}, [&](const Vec3& p) { return axis.dot(p); });
    return std::pair(axis.dot(low), axis.dot(high));
  };
  const auto [a_low, a_high] = range(a);
  const auto [b_low, b_high] = range(b);
  return std::min(a_high - b_low, b_high - a_low);
}

}  // namespace

double body_overlap_mm(const std::array<Vec3, 3>& a, const std::array<Vec3, 3>& b, double corner_cut_mm) {
  const Body first = body_of(a, corner_cut_mm), second = body_of(b, corner_cut_mm);
  double least = std::numeric_limits<double>::infinity();
  const auto try_axis = [&](const Vec3& axis) {
    least = std::min(least, overlap_along(axis, first, second));
    return least > 0.0;
  };
  if (!std::ranges::all_of(first.faces, try_axis) || !std::ranges::all_of(second.faces, try_axis)) return 0.0;
  for (const Vec3& e : first.edges) {
    for (const Vec3& f : second.edges) {
      const Vec3 axis = e.cross(f);
      const double sine = axis.norm();
      if (sine > kParallel && !try_axis(axis / sine)) return 0.0;
    }
  }
  return least;
}

}  // namespace triskin::lattice
