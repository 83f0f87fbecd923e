// SPDX-License-Identifier: GPL-3.0-or-later
#include "rigid.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "search_bound.hpp"
#include "triskin/design/design_types.hpp"

namespace triskin::lattice {

// Three points fix the plane; within it the best turn is the mean of the turns of the three corners, weighted by their
// distance (the planar case of Kabsch's fit, as complex numbers). The corners of the rest pose, from its centre, are
// 2/3 h at −150°, −30° and 90°, so that their conjugates are kRadius · (∓√3/2 + i/2), −i.
std::array<Vec3, 3> fit_rigid(const std::array<Vec3, 3>& target) {
  constexpr double kRadius = 2.0 * kHeight_mm / 3.0, kCos = 0.86602540378443864676;
  const Vec3 center = (target[0] + target[1] + target[2]) / 3.0;
  const Vec3 u = target[1] - target[0];
  const Vec3 x = u.normalized(), normal = u.cross(target[2] - target[0]).normalized(), y = normal.cross(x);
  const std::array<Vec3, 3> d{target[0] - center, target[1] - center, target[2] - center};
  const double x0 = d[0].dot(x), y0 = d[0].dot(y), x1 = d[1].dot(x), y1 = d[1].dot(y), x2 = d[2].dot(x),
               y2 = d[2].dot(y);
  double real = kCos * (x1 - x0) - 0.5 * (y0 + y1) + y2;
  double imaginary = kCos * (y1 - y0) + 0.5 * (x0 + x1) - x2;
  const double scale = kRadius / std::sqrt(real * real + imaginary * imaginary);
  const Vec3 right = scale * (real * x + imaginary * y), up = scale * (real * y - imaginary * x);
  return {Vec3(center - kCos * right - 0.5 * up), Vec3(center + kCos * right - 0.5 * up), Vec3(center + up)};
}

SideHeights walk_sides(const mesh::Surface& surface, const design::Outline& outline, double step_mm) {
  SideHeights h;
  const auto corners = outline.points();
  const std::size_t n = corners.size();
  mesh::SurfacePoint c = surface.closest(corners[0]);
  for (std::size_t s = 0; s < n; ++s) {
    const Vec3 side = corners[(s + 1) % n] - corners[s];
    const int samples = std::max(1, static_cast<int>(std::lround(side.norm() / step_mm)));
    for (int k = 0; k < samples; ++k) {
      const Vec3 p = corners[s] + side * (static_cast<double>(k) / samples);
      c = surface.closest(p, search_bound((p - c.position_mm).norm(), p));
      const double height = (p - c.position_mm).dot(surface.normal_at(c));
      h.lift_mm = std::max(h.lift_mm, height);
      h.depth_mm = std::max(h.depth_mm, -height);
    }
  }
  return h;
}

Vec3 held_to_surface(const mesh::Surface& surface, const Vec3& p, double overhang_mm, Vec3& foot) {
  const mesh::SurfacePoint found = surface.closest(p, search_bound((p - foot).norm(), p));
  foot = found.position_mm;
  if (overhang_mm <= 0.0 || !(surface.border_distance(foot) <= 1e-6)) return foot;
  const Vec3 off = p - foot, n = surface.normal_at(found), over = off - off.dot(n) * n;
  const double length = over.norm();
  return length <= overhang_mm ? Vec3(foot + over) : Vec3(foot + overhang_mm / length * over);
}

}  // namespace triskin::lattice
