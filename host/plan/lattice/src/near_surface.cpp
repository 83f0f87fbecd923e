// SPDX-License-Identifier: GPL-3.0-or-later
#include "near_surface.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "triskin/base/index.hpp"
#include "triskin/geometry/triangle.hpp"

namespace triskin::lattice {
namespace {

constexpr double kMargin_mm = 12.0;  // Queries farther out than this are rare and use the tree.
constexpr double kLargestVoxel_mm = 3.0;
constexpr double kSmallestVoxel_mm = 2.0;
constexpr double kMaxVoxels = 6e6;
constexpr std::size_t kMaxCandidates = 96;

}  // namespace

NearSurface::NearSurface(const mesh::Surface& surface)
    : surface_(surface), border_vertex_(surface.mesh().vertices.size(), false) {
  const Mesh& mesh = surface.mesh();
  Vec3 low = Vec3::Zero(), high = Vec3::Zero();
  if (!mesh.vertices.empty()) low = high = mesh.vertices.front();
  for (const Vec3& v : mesh.vertices) {
    low = low.cwiseMin(v);
    high = high.cwiseMax(v);
  }
  origin_ = low - Vec3::Constant(kMargin_mm);
  const Vec3 extent = high - low + Vec3::Constant(2.0 * kMargin_mm);
  const double face_mm = std::sqrt(surface.area_mm2() / std::max(1.0, static_cast<double>(mesh.faces.size())));
  size_mm_ =
      std::max(std::clamp(0.7 * face_mm, kSmallestVoxel_mm, kLargestVoxel_mm), std::cbrt(extent.prod() / kMaxVoxels));
  per_mm_ = 1.0 / size_mm_;
  for (int k = 0; k < 3; ++k) voxels_[at(k)] = static_cast<int>(extent[k] * per_mm_) + 1;
  index_.assign(at(voxels_[0]) * at(voxels_[1]) * at(voxels_[2]), -1);
  for (const auto& loop : surface.border_loops()) {
    for (const VertexIndex v : loop) border_vertex_[at(v)] = true;
  }
  for (const auto& f : mesh.faces) {
    border_face_.push_back(border_vertex_[at(f[0])] || border_vertex_[at(f[1])] || border_vertex_[at(f[2])]);
  }
}

const NearSurface::Voxel* NearSurface::voxel_at(const Vec3& query_mm) {
  const Vec3 q = (query_mm - origin_) * per_mm_;
  if (!(q.minCoeff() >= 0.0)) return nullptr;
  const std::array<int, 3> c{static_cast<int>(q[0]), static_cast<int>(q[1]), static_cast<int>(q[2])};
  if (c[0] >= voxels_[0] || c[1] >= voxels_[1] || c[2] >= voxels_[2]) return nullptr;
  int& index = index_[(at(c[2]) * at(voxels_[1]) + at(c[1])) * at(voxels_[0]) + at(c[0])];
  if (index < 0) index = fill(origin_ + size_mm_ * Vec3(c[0] + 0.5, c[1] + 0.5, c[2] + 0.5));
  return &filled_[at(index)];
}

// The face nearest to a point of the voxel is no farther from the middle than the face nearest to the middle plus the
// voxel's diagonal.
int NearSurface::fill(const Vec3& middle) {
  const double half = 0.5 * std::sqrt(3.0) * size_mm_;
  const mesh::SurfacePoint nearest = surface_.closest(middle);
  Voxel voxel;
  voxel.middle = middle;
  const double border_mm = surface_.border_distance(middle);
  voxel.border_mm = std::max(0.0, border_mm - half);
  voxel.may_be_over = border_mm - half <= nearest.distance_mm + half;
  if (nearest.distance_mm < kMargin_mm) {
    std::vector<std::pair<double, FaceIndex>> faces;
    surface_.faces_within(middle, nearest.distance_mm + 2.0 * half + 1e-6, faces);
    if (faces.size() <= kMaxCandidates) {
      std::ranges::sort(faces);
      voxel.first = static_cast<int>(candidates_.size());
      voxel.count = static_cast<int>(faces.size());
      const auto at_border = [this](const auto& entry) { return border_face_[at(entry.second)]; };
      voxel.may_be_over = voxel.may_be_over && std::ranges::any_of(faces, at_border);
      for (const auto& [squared, face] : faces) candidates_.push_back({face, std::sqrt(squared)});
    }
  }
  filled_.push_back(voxel);
  return static_cast<int>(filled_.size()) - 1;
}

Foot NearSurface::foot_on(FaceIndex face, const Vec3& weights, const Vec3& point, double squared) const {
  const auto& f = surface_.mesh().faces[at(face)];
  Foot foot;
  foot.point = point;
  foot.distance_mm = std::sqrt(squared);
  const Vec3 n = weights[0] * surface_.vertex_normal(VertexIndex(f[0])) +
                 weights[1] * surface_.vertex_normal(VertexIndex(f[1])) +
                 weights[2] * surface_.vertex_normal(VertexIndex(f[2]));
  const double length = n.norm();
  foot.normal = length > 1e-9 ? Vec3(n / length) : surface_.face_normal(face);
  for (std::size_t k = 0; k < 3; ++k) {
    if (weights[static_cast<int>(k)] == 1.0 && border_vertex_[at(f[k])]) foot.on_border = true;
    if (weights[static_cast<int>((k + 2) % 3)] == 0.0 && surface_.neighbours(face)[k] < 0) foot.on_border = true;
  }
  return foot;
}

Foot NearSurface::closest(const Vec3& query_mm) {
  const Voxel* voxel = voxel_at(query_mm);
  if (voxel == nullptr || voxel->count < 0) {
    const mesh::SurfacePoint p = surface_.closest(query_mm);
    return foot_on(p.face, p.barycentric, p.position_mm, p.distance_mm * p.distance_mm);
  }
  const Mesh& mesh = surface_.mesh();
  double best_squared = std::numeric_limits<double>::infinity();
  const double off_middle_mm = (query_mm - voxel->middle).norm();
  FaceIndex best = FaceIndex::none();
  Vec3 best_weights = Vec3::Zero(), best_point = Vec3::Zero();
  for (int k = voxel->first; k < voxel->first + voxel->count; ++k) {
    const auto [face, middle_mm] = candidates_[at(k)];
    const double at_least = middle_mm - off_middle_mm;
    // The list is sorted, so all later ones are farther.
    if (at_least > 0.0 && at_least * at_least > best_squared) break;
    const auto& f = mesh.faces[at(face)];
    const Vec3& a = mesh.vertices[at(f[0])];
    const double height = surface_.face_normal(face).dot(query_mm - a);
    if (height * height >= best_squared) continue;
    const Vec3 &b = mesh.vertices[at(f[1])], &c = mesh.vertices[at(f[2])];
    const Vec3 weights = geometry::closest_on_triangle(query_mm, a, b, c);
    const Vec3 p = weights[0] * a + weights[1] * b + weights[2] * c;
    const double squared = (p - query_mm).squaredNorm();
    if (squared >= best_squared) continue;
    best_squared = squared;
    best = face;
    best_weights = weights;
    best_point = p;
  }
  return foot_on(best, best_weights, best_point, best_squared);
}

bool NearSurface::may_be_over_border(const Vec3& query_mm) {
  const Voxel* voxel = voxel_at(query_mm);
  return voxel == nullptr || voxel->may_be_over;
}

double NearSurface::border_at_least(const Vec3& query_mm) {
  const Voxel* voxel = voxel_at(query_mm);
  return voxel != nullptr ? voxel->border_mm : surface_.border_distance(query_mm);
}

}  // namespace triskin::lattice
