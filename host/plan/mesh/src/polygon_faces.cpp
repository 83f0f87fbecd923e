// SPDX-License-Identifier: GPL-3.0-or-later
#include "polygon_faces.hpp"

#include <Eigen/Geometry>
#include <algorithm>

#include "triskin/base/index.hpp"

namespace triskin::mesh {
namespace {

constexpr std::size_t kMaxCorners = 300;  // Cutting ears off a larger polygon would take too long.

Vec3 normal_of(const Mesh& mesh, const std::vector<VertexIndex>& corners) {
  Vec3 sum = Vec3::Zero();
  const Vec3& origin = mesh.vertices[at(corners[0])];
  for (std::size_t k = 1; k + 1 < corners.size(); ++k)
    sum += (mesh.vertices[at(corners[k])] - origin).cross(mesh.vertices[at(corners[k + 1])] - origin);
  return sum;
}

// Tells whether corner k is an ear: convex, with no other corner in its triangle.
bool is_ear(const Mesh& mesh, const std::vector<VertexIndex>& corners, std::size_t k, const Vec3& normal) {
  const std::size_t n = corners.size();
  const VertexIndex ia = corners[(k + n - 1) % n], ib = corners[k], ic = corners[(k + 1) % n];
  const Vec3 &a = mesh.vertices[at(ia)], &b = mesh.vertices[at(ib)], &c = mesh.vertices[at(ic)];
  const auto left = [&](const Vec3& p, const Vec3& q, const Vec3& r) { return (q - p).cross(r - p).dot(normal); };
  if (!(left(a, b, c) > 0.0)) return false;
  return std::ranges::none_of(corners, [&](VertexIndex v) {
    const Vec3& p = mesh.vertices[at(v)];
    return v != ia && v != ib && v != ic && left(a, b, p) >= 0.0 && left(b, c, p) >= 0.0 && left(c, a, p) >= 0.0;
  });
}

}  // namespace

void add_polygon(Mesh& mesh, std::vector<VertexIndex> corners) {
  if (corners.size() < 3) return;
  if (corners.size() > kMaxCorners) {
    for (std::size_t k = 2; k < corners.size(); ++k) mesh.faces.push_back({corners[0], corners[k - 1], corners[k]});
    return;
  }
  const Vec3 normal = normal_of(mesh, corners);
  while (corners.size() > 3) {
    std::size_t ear = 1;  // If the polygon has no area, any corner will do.
    for (std::size_t k = 0; k < corners.size(); ++k) {
      const std::size_t tried = (k + 1) % corners.size();
      if (!is_ear(mesh, corners, tried, normal)) continue;
      ear = tried;
      break;
    }
    const std::size_t n = corners.size();
    mesh.faces.push_back({corners[(ear + n - 1) % n], corners[ear], corners[(ear + 1) % n]});
    corners.erase(corners.begin() + static_cast<std::ptrdiff_t>(ear));
  }
  mesh.faces.push_back({corners[0], corners[1], corners[2]});
}

}  // namespace triskin::mesh
