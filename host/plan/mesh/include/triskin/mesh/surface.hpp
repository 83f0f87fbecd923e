// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <array>
#include <limits>
#include <utility>
#include <vector>

#include "triskin/design/design_types.hpp"
#include "triskin/mesh/bvh.hpp"

namespace triskin::mesh {

/// Answers a closest-point query.
struct SurfacePoint {
  Vec3 position_mm = Vec3::Zero();
  FaceIndex face = FaceIndex::none();  ///< −1 means that no point was near enough.
  Vec3 barycentric = Vec3::Zero();     ///< These are the barycentric coordinates of `position_mm` in `face`.
  double distance_mm = std::numeric_limits<double>::infinity();
};

/// Answers which point of one border edge is closest.
struct BorderPoint {
  SurfacePoint point;
  int side = 0;  ///< Side s of a face runs from corner s to corner s + 1.
  /// The border passes through these vertices before and after the edge.
  std::array<VertexIndex, 2> beyond{VertexIndex::none(), VertexIndex::none()};
};

/// A manifold, oriented triangle surface with border that answers topology, normals and closest points. Immutable after
/// construction; all queries are const and thread-safe.
class Surface {
 public:
  /// Takes a mesh in mm. Errors: InputError when an edge has more than two faces, or two faces of an edge disagree in
  /// orientation. Cost: O(n log n).
  explicit Surface(Mesh mesh);

  /// Returns the mesh as it was given, unchanged.
  [[nodiscard]] const Mesh& mesh() const { return mesh_; }
  /// Returns the face across side s (corner s → s+1) of a face, -1 at the border.
  [[nodiscard]] const std::array<FaceIndex, 3>& neighbours(FaceIndex face) const {
    return neighbour_[static_cast<std::size_t>(face)];
  }
  /// Returns the outward unit normal of a face; zero for a face without area.
  [[nodiscard]] const Vec3& face_normal(FaceIndex face) const { return face_normal_[static_cast<std::size_t>(face)]; }
  /// Returns the unit normal of a vertex, the angle-weighted mean over its faces; zero if they cancel, as when a flap
  /// is folded back onto its own faces.
  [[nodiscard]] const Vec3& vertex_normal(VertexIndex vertex) const {
    return vertex_normal_[static_cast<std::size_t>(vertex)];
  }
  /// Interpolates the unit normal from the vertices of the point's face. Throws std::logic_error if it has none.
  [[nodiscard]] Vec3 normal_at(const SurfacePoint& point) const;
  /// Lists the border loops as vertex indices, with the surface on the left.
  [[nodiscard]] const std::vector<std::vector<VertexIndex>>& border_loops() const { return loops_; }
  /// Returns the area of all faces in mm².
  [[nodiscard]] double area_mm2() const { return area_mm2_; }

  /// Finds the closest point of the surface that is nearer than within_mm > 0; a bound that the caller knows makes the
  /// search shorter and does not change the answer. If there is no such point, `face` is −1 and the distance
  /// infinity. Cost: O(log n) typical.
  [[nodiscard]] SurfacePoint closest(const Vec3& query_mm,
                                     double within_mm = std::numeric_limits<double>::infinity()) const;
  /// Appends (squared distance in mm², face) of each face within distance_mm >= 0 of a point, in no order. Cost: O(log
  /// n + faces found) typical.
  void faces_within(const Vec3& query_mm, double distance_mm, std::vector<std::pair<double, FaceIndex>>& faces) const;
  /// Finds the closest point of the border polyline that is nearer than within_mm > 0; `face` is -1 and the distance
  /// infinity when there is none, as on a closed surface. Cost: O(log n) typical.
  [[nodiscard]] SurfacePoint closest_on_border(const Vec3& query_mm,
                                               double within_mm = std::numeric_limits<double>::infinity()) const;
  /// Appends the closest point of every border edge within distance_mm ≥ 0 of a point, with the edge's face and side,
  /// in no order. Cost: O(log n + edges found) typical.
  void border_within(const Vec3& query_mm, double distance_mm, std::vector<BorderPoint>& points) const;
  /// Returns the distance to the border polyline in mm; infinity when the surface is closed. Cost: as
  /// closest_on_border().
  [[nodiscard]] double border_distance(const Vec3& query_mm) const;

 private:
  [[nodiscard]] BorderPoint closest_on_edge(int item, const Vec3& query_mm) const;
  void compute_normals();
  void find_border();
  void build_trees();

  Mesh mesh_;
  std::vector<std::array<FaceIndex, 3>> neighbour_;
  std::vector<Vec3> face_normal_, vertex_normal_;
  std::vector<std::vector<VertexIndex>> loops_;
  struct BorderSide {
    FaceIndex face;
    int side;
    std::array<VertexIndex, 2> beyond;
  };
  std::vector<BorderSide> border_sides_;
  double area_mm2_ = 0.0;
  Bvh face_tree_, border_tree_;
};

}  // namespace triskin::mesh
