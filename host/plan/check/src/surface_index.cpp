// SPDX-License-Identifier: GPL-3.0-or-later
#include "surface_index.hpp"

#include <cmath>
#include <map>

namespace triskin::check {
namespace {

std::size_t at(int k) {
  return static_cast<std::size_t>(k);
}

// Normals of a vertex that cancel, as of a flap folded back onto its own faces, leave a sum of rounding errors, so the
// face decides there.
constexpr double kCancelled_rad = 1e-6, kNoNormal = 1e-9;

}  // namespace

SurfaceIndex::SurfaceIndex(const CheckedDesign& design)
    : design_(design), normals_(design.vertices.size(), P3::Zero()) {
  for (const auto& f : design.faces) {
    const Triangle3 t = triangle(f);
    const auto point = [&](std::size_t k) { return Kernel::Point_3(t[k].x(), t[k].y(), t[k].z()); };
    triangles_.emplace_back(point(0), point(1), point(2));
    for (std::size_t k = 0; k < 3; ++k) {
      const P3 u = (t[(k + 1) % 3] - t[k]).normalized(), v = (t[(k + 2) % 3] - t[k]).normalized();
      normals_[at(f[k])] += std::atan2(u.cross(v).norm(), u.dot(v)) * unit_normal(t);
    }
  }
  for (P3& n : normals_) n = n.norm() > kCancelled_rad ? P3(n.normalized()) : P3::Zero();
  find_border();
  tree_.insert(triangles_.cbegin(), triangles_.cend());
  tree_.build();
  tree_.accelerate_distance_queries();
}

void SurfaceIndex::find_border() {
  struct Use {
    int count = 0, from = 0, to = 0;
    P3 face_normal;
  };
  std::map<std::pair<int, int>, Use> edges;
  for (const auto& f : design_.faces) {
    for (std::size_t k = 0; k < 3; ++k) {
      Use& use = edges[std::minmax(f[k], f[(k + 1) % 3])];
      use = {use.count + 1, f[k], f[(k + 1) % 3], unit_normal(triangle(f))};
    }
  }
  for (const auto& [edge, use] : edges) {
    if (use.count != 1) continue;
    const P3 &a = design_.vertices[at(use.from)], &b = design_.vertices[at(use.to)];
    border_.push_back(
        {a, b, normals_[at(use.from)], normals_[at(use.to)], (b - a).cross(use.face_normal).normalized()});
  }
}

Triangle3 SurfaceIndex::triangle(const std::array<int, 3>& face) const {
  return {design_.vertices[at(face[0])], design_.vertices[at(face[1])], design_.vertices[at(face[2])]};
}

SurfaceIndex::Hit SurfaceIndex::closest(const P3& p) const {
  const auto [point, primitive] = tree_.closest_point_and_primitive(Kernel::Point_3(p.x(), p.y(), p.z()));
  Hit hit{{point.x(), point.y(), point.z()}, P3::Zero(), static_cast<std::size_t>(primitive - triangles_.cbegin())};
  const auto& f = design_.faces[hit.face];
  const Triangle3 t = triangle(f);
  const P3 n = (t[1] - t[0]).cross(t[2] - t[0]);
  for (std::size_t k = 0; k < 3; ++k) {
    const double weight = (t[(k + 2) % 3] - t[(k + 1) % 3]).cross(hit.point - t[(k + 1) % 3]).dot(n) / n.squaredNorm();
    hit.normal += weight * normals_[at(f[k])];
  }
  hit.normal = hit.normal.norm() > kNoNormal ? P3(hit.normal.normalized()) : unit_normal(t);
  return hit;
}

double SurfaceIndex::distance_to(std::size_t face, const P3& p) const {
  return std::sqrt(CGAL::squared_distance(Kernel::Point_3(p.x(), p.y(), p.z()), triangles_[face]));
}

double SurfaceIndex::distance(const P3& p) const {
  return std::sqrt(tree_.squared_distance(Kernel::Point_3(p.x(), p.y(), p.z())));
}

}  // namespace triskin::check
