// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <array>
#include <cstddef>
#include <vector>

#include "flat_star.hpp"
#include "triskin/mesh/surface.hpp"

namespace triskin::mesh {

/// Holds the faces of a surface while corners are collapsed onto neighbours, with bounds of how far each part has moved
/// from the surface. Queries are const and thread-safe between changes.
class CollapsingMesh {
 public:
  explicit CollapsingMesh(const Surface& surface);

  /// The faces around a corner, counter-clockwise, and its neighbours; an open ring has one neighbour more than faces.
  struct Ring {
    std::array<FaceIndex, FlatStar::kMaxCorners> faces;
    std::array<VertexIndex, FlatStar::kMaxCorners> corners;
    std::size_t n_faces = 0, n_corners = 0;
    [[nodiscard]] bool is_open() const { return n_corners > n_faces; }
  };
  /// Returns false for a corner that was removed, that has too many neighbours or at which several borders meet.
  [[nodiscard]] bool ring_of(VertexIndex vertex, Ring& ring) const;

  /// The best neighbour onto which a corner can be collapsed within the bounds.
  struct Move {
    VertexIndex onto = VertexIndex::none();  ///< −1 means that no move stays within the bounds.
    /// The new faces deviate by the first and the new border edge by the second.
    double deviation_mm = 0.0, border_mm = 0.0;
    /// Among the moves that only the limit ruled out, this is the least deviation; infinity means that there was none.
    double needs_mm;
  };
  [[nodiscard]] Move best_move(VertexIndex vertex, double deviation_mm, double border_mm) const;

  /// Collapses a corner onto a neighbour and appends the corners whose faces changed. Returns false and changes nothing
  /// if an edge would get more than two faces.
  bool collapse(VertexIndex vertex, const Move& move, std::vector<VertexIndex>& changed);

  /// Returns the number of remaining faces.
  [[nodiscard]] std::size_t n_faces() const { return n_faces_; }
  /// Returns the remaining faces in the old order, with the largest bounds.
  [[nodiscard]] Mesh mesh() const;
  [[nodiscard]] double deviation_mm() const;
  [[nodiscard]] double border_mm() const;

 private:
  [[nodiscard]] const Vec3& place(VertexIndex vertex) const { return places_[static_cast<std::size_t>(vertex)]; }
  [[nodiscard]] bool keeps_edges_single(VertexIndex vertex, const Ring& ring, std::size_t j) const;
  void remove_face(FaceIndex face, VertexIndex vertex, VertexIndex corner);
  void point_side(FaceIndex face, VertexIndex from, VertexIndex to, FaceIndex neighbour);

  const std::vector<Vec3>& places_;
  std::vector<std::array<int, 3>> faces_;  // A removed face has corners −1.
  std::vector<std::array<FaceIndex, 3>> neighbours_;
  std::size_t n_faces_;
  std::vector<FaceIndex> face_of_;  // Gives one face of each vertex; −1 marks a removed vertex.
  std::vector<char> is_locked_;     // True for a vertex whose faces are not a single fan.
  std::vector<float> deviation_;    // The bound of each face is rounded up.
  std::vector<float> border_;       // The index is the vertex at which the border edge begins; values are rounded up.
};

}  // namespace triskin::mesh
