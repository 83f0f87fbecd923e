// SPDX-License-Identifier: GPL-3.0-or-later
#include "triskin/mesh/open_side.hpp"

#include <Eigen/Geometry>
#include <map>
#include <utility>

namespace triskin::mesh {

OpenSide open_side_of(const design::Mesh& mesh) {
  using design::Vec3;
  const auto corner = [&](const std::array<int, 3>& f, std::size_t k) -> const Vec3& {
    return mesh.vertices[static_cast<std::size_t>(f[k])];
  };
  std::map<std::pair<int, int>, int> faces_at;
  Vec3 middle = Vec3::Zero(), normals = Vec3::Zero();
  double area = 0.0, inward = 0.0;
  const auto twice = [&](const std::array<int, 3>& f) -> Vec3 {
    return (corner(f, 1) - corner(f, 0)).cross(corner(f, 2) - corner(f, 0));
  };
  const auto center = [&](const std::array<int, 3>& f) -> Vec3 {
    return (corner(f, 0) + corner(f, 1) + corner(f, 2)) / 3.0;
  };
  for (const auto& f : mesh.faces) {
    area += twice(f).norm();
    normals += twice(f);
    middle += twice(f).norm() * center(f);
    for (std::size_t k = 0; k < 3; ++k) ++faces_at[std::minmax(f[k], f[(k + 1) % 3])];
  }
  OpenSide side;
  if (!(area > 0.0)) return side;
  middle /= area;
  for (const auto& f : mesh.faces)
    if (twice(f).dot(center(f) - middle) < 0.0) inward += twice(f).norm();
  for (const auto& [edge, count] : faces_at) side.is_open = side.is_open || count == 1;
  side.normal = normals / area;
  side.toward_middle = inward / area;
  return side;
}

void turn_over(design::Mesh& mesh) {
  for (auto& f : mesh.faces) std::swap(f[1], f[2]);
}

}  // namespace triskin::mesh
