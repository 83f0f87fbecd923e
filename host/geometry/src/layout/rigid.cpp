// SPDX-License-Identifier: GPL-3.0-or-later
#include "rigid.hpp"

#include <Eigen/Geometry>
#include <Eigen/SVD>
#include <algorithm>
#include <cmath>

#include "triskin/geometry/lattice.hpp"

namespace triskin::geometry {

std::array<Vec3, 3> fit_rigid(const std::array<Vec3, 3>& target) {
  static const std::array<Vec3, 3> kRest{Vec3(-15, -kHeight_mm / 3, 0), Vec3(15, -kHeight_mm / 3, 0), Vec3(0, 2 * kHeight_mm / 3, 0)};
  const Vec3 center = (target[0] + target[1] + target[2]) / 3.0;
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
  for (std::size_t k = 0; k < 3; ++k) covariance += (target[k] - center) * kRest[k].transpose();
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(covariance, Eigen::ComputeFullU | Eigen::ComputeFullV);
  Eigen::Vector3d sign(1, 1, (svd.matrixU() * svd.matrixV().transpose()).determinant() < 0 ? -1 : 1);
  const Eigen::Matrix3d rotation = svd.matrixU() * sign.asDiagonal() * svd.matrixV().transpose();
  return {Vec3(center + rotation * kRest[0]), Vec3(center + rotation * kRest[1]), Vec3(center + rotation * kRest[2])};
}

namespace {

// Tangential distance to the border where that is the nearest of the surface, else a negative number.
double standing_over(const Surface& surface, const Vec3& p) {
  const SurfacePoint c = surface.closest(p);
  if (surface.border_distance(c.position_mm) >= 1e-6) return -1.0;
  const Vec3 d = p - c.position_mm, n = surface.normal_at(c);
  return (d - d.dot(n) * n).norm();
}

// Largest overrun on a stretch of a side. Both distances change by no more than the way along the side: a stretch whose middle is
// that much nearer to the surface than to its border has none. Where the stretch leaves the surface it is divided finely, because
// normals between vertices turn there at once; farther out the overrun changes slowly.
void walk_over_border(const Surface& surface, const Vec3& from, const Vec3& to, double& best) {
  constexpr double kFine_mm = 0.01, kPlateau_mm = 0.1;
  const Vec3 middle = 0.5 * (from + to);
  const double length = (to - from).norm();
  if (surface.border_distance(middle) - surface.closest(middle).distance_mm > length) return;
  const double over = standing_over(surface, middle);
  best = std::max(best, over);
  if (over >= 0.0 && (length < kPlateau_mm || over + length < best)) {
    if (standing_over(surface, from) >= 0.0 && standing_over(surface, to) >= 0.0) return;
  }
  if (length < kFine_mm) return;
  walk_over_border(surface, from, middle, best);
  walk_over_border(surface, middle, to, best);
}

// The same over the area: notches and holes of the border under the module. Points of the part lie within `radius` of its middle.
void search_over_border(const Surface& surface, const std::array<Vec3, 3>& part, double radius, double& best) {
  constexpr double kFine_mm = 0.12;
  const Vec3 middle = (part[0] + part[1] + part[2]) / 3.0;
  if (surface.border_distance(middle) - surface.closest(middle).distance_mm > 2.0 * radius) return;
  const double over = standing_over(surface, middle);
  best = std::max(best, over);
  if (radius < kFine_mm || (over >= 0.0 && over + 2.0 * radius < best)) return;
  const Vec3 ab = 0.5 * (part[0] + part[1]), bc = 0.5 * (part[1] + part[2]), ca = 0.5 * (part[2] + part[0]);
  for (const auto& quarter : {std::array{part[0], ab, ca}, std::array{part[1], bc, ab}, std::array{part[2], ca, bc}, std::array{ab, bc, ca}}) {
    search_over_border(surface, quarter, 0.5 * radius, best);
  }
}

}  // namespace

SideMetrics walk_sides(const Surface& surface, const std::array<Vec3, 3>& corners, int samples) {
  SideMetrics m;
  for (std::size_t s = 0; s < 3; ++s) {
    m.overrun_mm = std::max(m.overrun_mm, standing_over(surface, corners[s]));
    for (int k = 0; k < samples; ++k) {
      const Vec3 p = corners[s] + (corners[(s + 1) % 3] - corners[s]) * (static_cast<double>(k) / samples);
      const SurfacePoint c = surface.closest(p);
      m.depth_mm = std::max(m.depth_mm, (c.position_mm - p).dot(surface.normal_at(c)));
    }
  }
  for (std::size_t s = 0; s < 3; ++s) walk_over_border(surface, corners[s], corners[(s + 1) % 3], m.overrun_mm);
  return m;
}

double overrun_of_area(const Surface& surface, const std::array<Vec3, 3>& corners, double known_mm) {
  const Vec3 c = (corners[0] + corners[1] + corners[2]) / 3.0;
  search_over_border(surface, corners, (corners[0] - c).norm(), known_mm);
  return known_mm;
}

}  // namespace triskin::geometry
