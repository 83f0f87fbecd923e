// SPDX-License-Identifier: GPL-3.0-or-later
#include "triskin/mesh/surface.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "edge_sides.hpp"
#include "triangle_tree.hpp"
#include "triskin/base/index.hpp"
#include "triskin/base/parallel.hpp"
#include "triskin/geometry/segment.hpp"
#include "triskin/geometry/triangle.hpp"

namespace triskin::mesh {
namespace {

// The sum of a vertex's normals, weighted by angle, must be at least this long. A shorter one comes from rounding of
// normals that cancel, and its direction would depend on the order of the sum.
constexpr double kCancelled_rad = 1e-6;

}  // namespace

Surface::Surface(Mesh mesh) : mesh_(std::move(mesh)), neighbour_(neighbours_of(mesh_)) {
  compute_normals();
  find_border();
  build_trees();
}

void Surface::compute_normals() {
  vertex_normal_.assign(mesh_.vertices.size(), Vec3::Zero());
  face_normal_.reserve(mesh_.faces.size());
  for (const auto& f : mesh_.faces) {
    const std::array p{mesh_.vertices[at(f[0])], mesh_.vertices[at(f[1])], mesh_.vertices[at(f[2])]};
    const Vec3 n = (p[1] - p[0]).cross(p[2] - p[0]);
    area_mm2_ += 0.5 * n.norm();
    face_normal_.push_back(n.normalized());
    for (int k = 0; k < 3; ++k) {
      const Vec3 u = (p[at((k + 1) % 3)] - p[at(k)]).normalized(), v = (p[at((k + 2) % 3)] - p[at(k)]).normalized();
      vertex_normal_[at(f[at(k)])] += geometry::angle_between(u, v) * face_normal_.back();
    }
  }
  for (Vec3& n : vertex_normal_) n = n.norm() > kCancelled_rad ? Vec3(n.normalized()) : Vec3::Zero();
}

void Surface::find_border() {
  std::vector<VertexIndex> before(mesh_.vertices.size(), VertexIndex::none()),
      after = before;  // The walk follows the border; of several edges at a vertex, the last one counts.
  for (std::size_t f = 0; f < mesh_.faces.size(); ++f) {
    for (int s = 0; s < 3; ++s) {
      if (neighbour_[f][at(s)] >= 0) continue;
      const VertexIndex from(mesh_.faces[f][at(s)]), to(mesh_.faces[f][at((s + 1) % 3)]);
      after[at(from)] = to;
      before[at(to)] = from;
      border_sides_.push_back({FaceIndex(f), s, {from, to}});
    }
  }
  for (BorderSide& side : border_sides_) side.beyond = {before[at(side.beyond[0])], after[at(side.beyond[1])]};
  loops_ = border_loops_of(mesh_, neighbour_);
}

void Surface::build_trees() {
  face_tree_ = tree_of_faces(mesh_, all_threads());
  std::vector<Bvh::Extent> extents;
  for (const auto& [face, side, beyond] : border_sides_) {
    const auto& f = mesh_.faces[at(face)];
    const auto a = mesh_.vertices[at(f[at(side)])].array(), b = mesh_.vertices[at(f[at((side + 1) % 3)])].array();
    extents.push_back({Eigen::Array3d(a.min(b)), Eigen::Array3d(a.max(b))});
  }
  border_tree_ = Bvh(extents);
}

SurfacePoint Surface::closest(const Vec3& query_mm, double within_mm) const {
  return closest_face_point(face_tree_, mesh_, query_mm, within_mm);
}

void Surface::faces_within(const Vec3& query_mm, double distance_mm,
                           std::vector<std::pair<double, FaceIndex>>& faces) const {
  double limit = std::nextafter(distance_mm * distance_mm, std::numeric_limits<double>::infinity());
  face_tree_.nearest(query_mm, limit, [&](int face) {
    const auto& f = mesh_.faces[at(face)];
    const Vec3 &a = mesh_.vertices[at(f[0])], &b = mesh_.vertices[at(f[1])], &c = mesh_.vertices[at(f[2])];
    const Vec3 weights = geometry::closest_on_triangle(query_mm, a, b, c);
    const double squared = (weights[0] * a + weights[1] * b + weights[2] * c - query_mm).squaredNorm();
    if (squared < limit) faces.emplace_back(squared, FaceIndex(face));
  });
}

BorderPoint Surface::closest_on_edge(int item, const Vec3& query_mm) const {
  const auto& [face, side, beyond] = border_sides_[at(item)];
  const auto& f = mesh_.faces[at(face)];
  const Vec3 &a = mesh_.vertices[at(f[at(side)])], &b = mesh_.vertices[at(f[at((side + 1) % 3)])];
  const double t = geometry::part_of_segment(query_mm, a, b);
  BorderPoint closest{{a + t * (b - a), face, Vec3::Zero(), 0.0}, side, beyond};
  closest.point.barycentric[side] = 1.0 - t;
  closest.point.barycentric[(side + 1) % 3] = t;
  return closest;
}

SurfacePoint Surface::closest_on_border(const Vec3& query_mm, double within_mm) const {
  SurfacePoint best;
  double best_squared = within_mm * within_mm;
  border_tree_.nearest(query_mm, best_squared, [&](int item) {
    const BorderPoint closest = closest_on_edge(item, query_mm);
    const double squared = (closest.point.position_mm - query_mm).squaredNorm();
    if (squared >= best_squared) return;
    best_squared = squared;
    best = closest.point;
  });
  if (best.face >= 0) best.distance_mm = std::sqrt(best_squared);
  return best;
}

void Surface::border_within(const Vec3& query_mm, double distance_mm, std::vector<BorderPoint>& points) const {
  double limit = std::nextafter(distance_mm * distance_mm, std::numeric_limits<double>::infinity());
  border_tree_.nearest(query_mm, limit, [&](int item) {
    BorderPoint closest = closest_on_edge(item, query_mm);
    const double squared = (closest.point.position_mm - query_mm).squaredNorm();
    if (squared >= limit) return;
    closest.point.distance_mm = std::sqrt(squared);
    points.push_back(closest);
  });
}

double Surface::border_distance(const Vec3& query_mm) const {
  return closest_on_border(query_mm).distance_mm;
}

Vec3 Surface::normal_at(const SurfacePoint& point) const {
  if (point.face < 0) throw std::logic_error("surface: a normal was asked for where no point of the surface was found");
  const auto& f = mesh_.faces[at(point.face)];
  const Vec3 n = point.barycentric[0] * vertex_normal_[at(f[0])] + point.barycentric[1] * vertex_normal_[at(f[1])] +
                 point.barycentric[2] * vertex_normal_[at(f[2])];
  return n.norm() > 1e-9 ? Vec3(n.normalized()) : face_normal_[at(point.face)];
}

}  // namespace triskin::mesh
