// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <array>
#include <cstddef>
#include <vector>

#include "flat_star.hpp"
#include "triskin/mesh/surface.hpp"

namespace triskin::geometry {

/// The faces of a surface while corners are drawn onto neighbours, with the bounds of how far each part is from the
/// surface by now. Queries are const and thread-safe between changes.
class CollapsingMesh {
 public:
  explicit CollapsingMesh(const Surface& surface);

  /// The faces round a corner, counter-clockwise, and its neighbours: of an open ring one more.
  struct Ring {
    std::array<int, FlatStar::kMaxCorners> faces, corners;
    std::size_t n_faces = 0, n_corners = 0;
    [[nodiscard]] bool is_open() const { return n_corners > n_faces; }
  };
  /// False for a corner that is gone, that has too many neighbours or where borders meet.
  [[nodiscard]] bool ring_of(int vertex, Ring& ring) const;

  /// The best neighbour that a corner can be drawn onto within the bounds.
  struct Move {
    int onto = -1;  ///< It is −1 when the point lies within none of them.
    /// The new faces deviate by the first and the new border edge by the second.
    double deviation_mm = 0.0, border_mm = 0.0;
    /// It is the least deviation among moves that only the limit ruled out; infinity means that there was none.
    double needs_mm;
  };
  [[nodiscard]] Move best_move(int vertex, double deviation_mm, double border_mm) const;

  /// Draws a corner onto a neighbour; appends the corners whose faces changed. False, and nothing is changed, where an
  /// edge would get more than two faces.
  bool collapse(int vertex, const Move& move, std::vector<int>& changed);

  /// Number of faces that are left.
  [[nodiscard]] std::size_t n_faces() const { return n_faces_; }
  /// What is left, in the old order, and the largest bounds.
  [[nodiscard]] Mesh mesh() const;
  [[nodiscard]] double deviation_mm() const;
  [[nodiscard]] double border_mm() const;

 private:
  [[nodiscard]] const Vec3& place(int vertex) const { return places_[static_cast<std::size_t>(vertex)]; }
  [[nodiscard]] bool keeps_edges_single(int vertex, const Ring& ring, std::size_t j) const;
  void remove_face(int face, int vertex, int corner);
  void point_side(int face, int from, int to, int neighbour);

  const std::vector<Vec3>& places_;
  std::vector<std::array<int, 3>> faces_, neighbours_;  // A removed face has corners −1.
  std::size_t n_faces_;
  std::vector<int> face_of_;      // Vertex → one of its faces, −1: removed.
  std::vector<char> is_locked_;   // Indexed by vertex: its faces are not a single fan.
  std::vector<float> deviation_;  // Indexed by face, rounded up.
  std::vector<float> border_;     // Indexed by the vertex at which the border edge begins, rounded up.
};

}  // namespace triskin::geometry
