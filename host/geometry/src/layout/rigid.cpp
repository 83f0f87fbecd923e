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

struct Standing {
  double over_mm, depth_mm;
};
Standing standing_at(const Surface& surface, const Vec3& p) {
  const SurfacePoint c = surface.closest(p);
  const Vec3 d = p - c.position_mm, n = surface.normal_at(c);
  const bool border = surface.border_distance(c.position_mm) < 1e-6;
  return {border ? (d - d.dot(n) * n).norm() : 0.0, -d.dot(n)};
}

// Between the steps beside the largest value: a notch of the border may be narrower than a step.
double refined(const Surface& surface, const Vec3& from, const Vec3& to) {
  double low = 0.0, high = 1.0, best = 0.0;
  for (int k = 0; k < 12; ++k) {
    const double a = low + (high - low) / 3.0, b = high - (high - low) / 3.0;
    const double at_a = standing_at(surface, from + a * (to - from)).over_mm, at_b = standing_at(surface, from + b * (to - from)).over_mm;
    best = std::max({best, at_a, at_b});
    (at_a < at_b ? low : high) = at_a < at_b ? a : b;
  }
  return best;
}

bool covers(const std::array<Vec3, 3>& corners, const Vec3& p) {
  const Vec3 n = (corners[1] - corners[0]).cross(corners[2] - corners[0]).normalized();
  if (std::abs(n.dot(p - corners[0])) > 10.0) return false;
  for (std::size_t s = 0; s < 3; ++s) {
    if (n.cross(corners[(s + 1) % 3] - corners[s]).dot(p - corners[s]) < 0.0) return false;
  }
  return true;
}

// From a point of the border outwards, as long as it goes away from the border and stays under the module.
double march_out(const Surface& surface, const std::array<Vec3, 3>& corners, const Vec3& p, const Vec3& out) {
  constexpr double kStep_mm = 0.2;
  const Vec3 n = (corners[1] - corners[0]).cross(corners[2] - corners[0]).normalized();
  double best = 0.0;
  for (Vec3 q = p + kStep_mm * out; covers(corners, q); q += kStep_mm * out) {
    const double over = standing_at(surface, q - n.dot(q - corners[0]) * n).over_mm;
    if (over <= best) break;
    best = over;
  }
  return best;
}

}  // namespace

SideMetrics walk_sides(const Surface& surface, const std::array<Vec3, 3>& corners, int samples) {
  SideMetrics m;
  for (std::size_t s = 0; s < 3; ++s) {
    const Vec3 d = (corners[(s + 1) % 3] - corners[s]) / samples;
    double over = 0.0;
    int where = 0;
    for (int k = 0; k < samples; ++k) {
      const Standing here = standing_at(surface, corners[s] + k * d);
      m.depth_mm = std::max(m.depth_mm, here.depth_mm);
      if (here.over_mm <= over) continue;
      over = here.over_mm;
      where = k;
    }
    if (over > 0.0) over = std::max(over, refined(surface, corners[s] + std::max(0, where - 1) * d, corners[s] + (where + 1) * d));
    m.overrun_mm = std::max(m.overrun_mm, over);
  }
  return m;
}

double overrun_inside(const Surface& surface, const std::array<Vec3, 3>& corners) {
  const Vec3 c = (corners[0] + corners[1] + corners[2]) / 3.0;
  const auto& v = surface.mesh().vertices;
  double most = 0.0;
  for (const auto& loop : surface.border_loops()) {
    for (std::size_t k = 0; k < loop.size(); ++k) {
      const int i = loop[k], j = loop[(k + 1) % loop.size()];
      const Vec3 &a = v[static_cast<std::size_t>(i)], &b = v[static_cast<std::size_t>(j)];
      const double length = (b - a).norm();
      if ((0.5 * (a + b) - c).norm() > 0.5 * length + 20.0) continue;
      const Vec3 out = (b - a).cross(surface.vertex_normal(i) + surface.vertex_normal(j)).normalized();
      const int parts = static_cast<int>(std::ceil(length));
      for (int q = 0; q < parts; ++q) {
        const Vec3 p = a + (b - a) * ((q + 0.5) / parts);
        if (covers(corners, p)) most = std::max(most, march_out(surface, corners, p, out));
      }
    }
  }
  return most;
}

}  // namespace triskin::geometry
