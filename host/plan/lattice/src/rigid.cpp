// SPDX-License-Identifier: GPL-3.0-or-later
#include "rigid.hpp"

#include <Eigen/Geometry>
#include <Eigen/SVD>
#include <algorithm>
#include <cmath>

#include "search_bound.hpp"
#include "triskin/design/design_types.hpp"

namespace triskin::lattice {

std::array<Vec3, 3> fit_rigid(const std::array<Vec3, 3>& target) {
  static const std::array<Vec3, 3> kRest{Vec3(-15, -kHeight_mm / 3, 0), Vec3(15, -kHeight_mm / 3, 0),
                                         Vec3(0, 2 * kHeight_mm / 3, 0)};
  const Vec3 center = (target[0] + target[1] + target[2]) / 3.0;
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
  for (std::size_t k = 0; k < 3; ++k) covariance += (target[k] - center) * kRest[k].transpose();
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(covariance, Eigen::ComputeFullU | Eigen::ComputeFullV);
  Eigen::Vector3d sign(1, 1, (svd.matrixU() * svd.matrixV().transpose()).determinant() < 0 ? -1 : 1);
  const Eigen::Matrix3d rotation = svd.matrixU() * sign.asDiagonal() * svd.matrixV().transpose();
  return {Vec3(center + rotation * kRest[0]), Vec3(center + rotation * kRest[1]), Vec3(center + rotation * kRest[2])};
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
      c = surface.closest(p, search_bound((p - c.position_mm).norm()));
      const double height = (p - c.position_mm).dot(surface.normal_at(c));
      h.lift_mm = std::max(h.lift_mm, height);
      h.depth_mm = std::max(h.depth_mm, -height);
    }
  }
  return h;
}

Vec3 held_to_surface(const mesh::Surface& surface, const Vec3& p, double overhang_mm, Vec3& foot) {
  const mesh::SurfacePoint found = surface.closest(p, search_bound((p - foot).norm()));
  foot = found.position_mm;
  if (overhang_mm <= 0.0 || !(surface.border_distance(foot) <= 1e-6)) return foot;
  const Vec3 off = p - foot, n = surface.normal_at(found), over = off - off.dot(n) * n;
  const double length = over.norm();
  return length <= overhang_mm ? Vec3(foot + over) : Vec3(foot + overhang_mm / length * over);
}

}  // namespace triskin::lattice
