// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <limits>
#include <vector>

#include "triskin/design/design_types.hpp"
#include "triskin/mesh/bvh.hpp"

namespace triskin::mesh {

/// The first face that a ray meets.
struct RayHit {
  FaceIndex face = FaceIndex::none();  ///< −1 means that the ray meets none.
  double distance_mm = std::numeric_limits<double>::infinity();
};

/// Casts rays against the triangles of a mesh, which must outlive it. Queries are const and thread-safe.
class RayCaster {
 public:
  /// Builds the tree of the faces on `threads` (≥ 1). Cost: O(n log n).
  RayCaster(const Mesh& mesh, int threads);

  [[nodiscard]] const Mesh& mesh() const { return mesh_; }
  /// Returns the unit normal of a face; zero for one without area.
  [[nodiscard]] const Vec3& normal(FaceIndex face) const { return normals_[static_cast<std::size_t>(face)]; }
  /// Returns the length of the edge from corner `side` (0 … 2) of a face to the next one.
  [[nodiscard]] double edge_mm(std::size_t face, std::size_t side) const {
    const auto& f = mesh_.faces[face];
    const auto corner = [&](std::size_t k) { return mesh_.vertices[static_cast<std::size_t>(f[k])]; };
    return (corner((side + 1) % 3) - corner(side)).norm();
  }
  [[nodiscard]] double area_mm2(FaceIndex face) const { return areas_mm2_[static_cast<std::size_t>(face)]; }

  /// Returns the first face between two distances along a unit direction, ignoring `but_face`. Cost: O(log n) typical.
  [[nodiscard]] RayHit first_hit(const Vec3& from_mm, const Vec3& direction, double nearest_mm, double farthest_mm,
                                 FaceIndex but_face) const;
  /// Returns true if the ray leaves the part without a hit within `farthest_mm`. Cost: O(log n) typical.
  [[nodiscard]] bool is_free(const Vec3& from_mm, const Vec3& direction, double farthest_mm) const;

 private:
  const Mesh& mesh_;
  Bvh tree_;
  std::vector<Vec3> normals_;
  std::vector<double> areas_mm2_;
};

}  // namespace triskin::mesh
