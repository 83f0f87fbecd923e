// SPDX-License-Identifier: GPL-3.0-or-later
#include "triskin/unfolding/developability.hpp"

#include <cmath>
#include <numbers>
#include <vector>

#include "triskin/base/index.hpp"

namespace triskin::unfolding {

double total_curvature_rad(const mesh::Surface& surface) {
  const Mesh& mesh = surface.mesh();
  std::vector<double> angles(mesh.vertices.size(), 0.0);
  for (const auto& face : mesh.faces) {
    for (std::size_t k = 0; k < 3; ++k) {
      const Vec3 a = mesh.vertices[at(face[(k + 1) % 3])] - mesh.vertices[at(face[k])];
      const Vec3 b = mesh.vertices[at(face[(k + 2) % 3])] - mesh.vertices[at(face[k])];
      angles[at(face[k])] += std::atan2(a.cross(b).norm(), a.dot(b));
    }
  }
  std::vector<bool> is_inside(mesh.vertices.size(), true);
  for (const auto& loop : surface.border_loops()) {
    for (const VertexIndex v : loop) is_inside[at(v)] = false;
  }
  double total = 0.0;
  for (std::size_t v = 0; v < angles.size(); ++v) {
    if (is_inside[v] && angles[v] > 0.0) total += std::abs(2.0 * std::numbers::pi - angles[v]);
  }
  return total;
}

}  // namespace triskin::unfolding
