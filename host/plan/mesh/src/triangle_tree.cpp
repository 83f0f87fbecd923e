// SPDX-License-Identifier: GPL-3.0-or-later
#include "triangle_tree.hpp"

#include <cmath>

#include "triskin/base/index.hpp"
#include "triskin/geometry/triangle.hpp"

namespace triskin::mesh {

std::vector<Bvh::Extent> extents_of_faces(const Mesh& mesh) {
  std::vector<Bvh::Extent> extents;
  extents.reserve(mesh.faces.size());
  for (const auto& f : mesh.faces) {
    const auto a = mesh.vertices[at(f[0])].array(), b = mesh.vertices[at(f[1])].array(),
               c = mesh.vertices[at(f[2])].array();
    extents.push_back({Eigen::Array3d(a.min(b).min(c)), Eigen::Array3d(a.max(b).max(c))});
  }
  return extents;
}

Bvh tree_of_faces(const Mesh& mesh, int threads) {
  return Bvh(extents_of_faces(mesh), threads);
}

SurfacePoint closest_face_point(const Bvh& tree, const Mesh& mesh, const Vec3& query_mm, double within_mm) {
  SurfacePoint best;
  double best_squared = within_mm * within_mm;
  tree.nearest(query_mm, best_squared, [&](int face) {
    const auto& f = mesh.faces[at(face)];
    const Vec3 &a = mesh.vertices[at(f[0])], &b = mesh.vertices[at(f[1])], &c = mesh.vertices[at(f[2])];
    const Vec3 weights = geometry::closest_on_triangle(query_mm, a, b, c);
    const Vec3 p = weights[0] * a + weights[1] * b + weights[2] * c;
    const double squared = (p - query_mm).squaredNorm();
    if (squared < best_squared) {
      best_squared = squared;
      best = {p, FaceIndex(face), weights, 0.0};
    }
  });
  if (best.face >= 0) best.distance_mm = std::sqrt(best_squared);
  return best;
}

}  // namespace triskin::mesh
