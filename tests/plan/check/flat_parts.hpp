// SPDX-License-Identifier: GPL-3.0-or-later
// Makes parts of flat faces, and poses for them.
#pragma once
#include <Eigen/Geometry>
#include <cmath>
#include <numbers>
#include <random>
#include <utility>

#include "triskin/design/mesh.hpp"

namespace triskin::check::parts {

using design::Mesh;
using design::Vec3;

/// Makes two plates of width × length mm each, joined along a side under `fold_rad` (0: one flat plate, < 0: a
/// valley).
inline Mesh ridge(double width_mm, double length_mm, double fold_rad) {
  const Vec3 left{-width_mm * std::cos(0.5 * fold_rad), 0, -width_mm * std::sin(0.5 * fold_rad)};
  const Vec3 right{-left.x(), 0, left.z()}, along{0, length_mm, 0}, middle = Vec3::Zero();
  return {{left, middle, right, left + along, middle + along, right + along},
          {{0, 1, 4}, {0, 4, 3}, {1, 2, 5}, {1, 5, 4}}};
}

/// Makes an open prism: `sides` walls of height_mm on a regular polygon whose corners are radius_mm from its middle,
/// and a lid.
inline Mesh prism(int sides, double radius_mm, double height_mm) {
  Mesh mesh;
  for (const double z : {0.0, height_mm}) {
    for (int k = 0; k < sides; ++k) {
      const double angle = 2.0 * std::numbers::pi * k / sides;
      mesh.vertices.push_back({radius_mm * std::cos(angle), radius_mm * std::sin(angle), z});
    }
  }
  for (int k = 0; k < sides; ++k) {
    const int next = (k + 1) % sides;
    mesh.faces.push_back({k, next, next + sides});
    mesh.faces.push_back({k, next + sides, k + sides});
    if (k >= 2) mesh.faces.push_back({sides, sides + k - 1, sides + k});
  }
  return mesh;
}

/// The box has four walls and a lid.
inline Mesh box(double x_mm, double y_mm, double z_mm) {
  Mesh mesh = prism(4, 1.0, z_mm);
  constexpr std::pair<int, int> kCorners[] = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
  for (std::size_t k = 0; k < mesh.vertices.size(); ++k) {
    const auto [x, y] = kCorners[k % 4];
    mesh.vertices[k] = {x * x_mm, y * y_mm, mesh.vertices[k].z()};
  }
  return mesh;
}

/// Turns the mesh at random and moves its origin `offset_mm` from the frame's in a random direction.
inline Mesh in_pose(Mesh mesh, double offset_mm, std::mt19937_64& random) {
  std::normal_distribution<double> normal;
  const auto draw = [&] { return normal(random); };
  const double w = draw(), x = draw(), y = draw(), z = draw();
  const Eigen::Quaterniond turn = Eigen::Quaterniond(w, x, y, z).normalized();
  const double a = draw(), b = draw(), c = draw();
  const Vec3 shift = offset_mm * Vec3{a, b, c}.normalized();
  for (Vec3& v : mesh.vertices) v = turn * v + shift;
  return mesh;
}

}  // namespace triskin::check::parts
