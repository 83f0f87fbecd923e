// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <limits>
#include <vector>

#include "triskin/mesh/bvh.hpp"
#include "triskin/mesh/surface.hpp"

namespace triskin::mesh {

[[nodiscard]] std::vector<Bvh::Extent> extents_of_faces(const Mesh& mesh);
/// Builds the tree of these boxes on `threads` (≥ 1).
[[nodiscard]] Bvh tree_of_faces(const Mesh& mesh, int threads = 1);

/// Returns the closest point of the mesh from which `tree` was made, if it is nearer than within_mm; otherwise face -1
/// and distance infinity.
[[nodiscard]] SurfacePoint closest_face_point(const Bvh& tree, const Mesh& mesh, const Vec3& query_mm,
                                              double within_mm = std::numeric_limits<double>::infinity());

/// Finds closest points of any set of triangles, which need not be a surface. The mesh must outlive it. Queries are
/// thread-safe.
class TriangleTree {
 public:
  explicit TriangleTree(const Mesh& mesh) : mesh_(mesh), tree_(tree_of_faces(mesh)) {}

  [[nodiscard]] const Mesh& mesh() const { return mesh_; }
  /// Returns the point of the triangles that is closest to the query. Cost: O(log n) typical.
  [[nodiscard]] SurfacePoint closest(const Vec3& query_mm) const { return closest_face_point(tree_, mesh_, query_mm); }

 private:
  const Mesh& mesh_;
  Bvh tree_;
};

}  // namespace triskin::mesh
