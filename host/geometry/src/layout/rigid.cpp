// SPDX-License-Identifier: GPL-3.0-or-later
#include "rigid.hpp"

#include <Eigen/SVD>

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

SideMetrics walk_sides(const Surface& surface, const std::array<Vec3, 3>& corners, int samples) {
  SideMetrics m;
  for (std::size_t s = 0; s < 3; ++s) {
    for (int k = 0; k < samples; ++k) {
      const Vec3 p = corners[s] + (corners[(s + 1) % 3] - corners[s]) * (static_cast<double>(k) / samples);
      const SurfacePoint c = surface.closest(p);
      const Vec3 d = p - c.position_mm;
      const Vec3 n = surface.normal_at(c);
      m.depth_mm = std::max(m.depth_mm, -d.dot(n));
      if (surface.border_distance(c.position_mm) < 1e-6) m.overrun_mm = std::max(m.overrun_mm, (d - d.dot(n) * n).norm());
    }
  }
  return m;
}

}  // namespace triskin::geometry
