// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <array>
#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "triskin/design/design_types.hpp"

namespace triskin::mesh {

/// Names a side of a face (corner `side` → `side` + 1), with the vertices of its edge.
struct EdgeSide {
  VertexIndex low, high;  ///< The lower one comes first.
  FaceIndex face;
  int side;
};

/// Lists the sides of all faces of any mesh, with those of one edge beside each other. It sorts by buckets: a tree of
/// edges took most of the time of the functions that join and test meshes of 100,000 faces.
class EdgeSides {
 public:
  /// Sorts the sides of all faces. Cost: O(n) for vertices of bounded degree.
  explicit EdgeSides(const Mesh& mesh);

  /// Calls `work` with the sides of each edge, in the order of faces and their sides; edges follow the order of their
  /// vertices.
  void each_edge(const auto& work) const {
    for (std::size_t first = 0, end = 0; first < sides_.size(); first = end) {
      while (end < sides_.size() && sides_[end].low == sides_[first].low && sides_[end].high == sides_[first].high)
        ++end;
      work(std::span(sides_).subspan(first, end - first));
    }
  }

 private:
  std::vector<EdgeSide> sides_;
};

/// Returns the face across each side (corner s → s + 1) of each face, −1 at the border. Errors: InputError when an
/// edge has more than two faces, or two that disagree in orientation. Cost: that of EdgeSides.
[[nodiscard]] std::vector<std::array<FaceIndex, 3>> neighbours_of(const Mesh& mesh);

/// A point where the faces cannot all be turned to one side: a part of the mesh has only one, as a Möbius strip has.
/// Nothing if every part has two. Edges with more than two faces join nothing here. Cost: that of EdgeSides.
[[nodiscard]] std::optional<Vec3> one_sided_at(const Mesh& mesh);

/// Counts the edges with more than two faces. Cost: that of EdgeSides.
[[nodiscard]] int non_manifold_edges_of(const Mesh& mesh);

/// Returns the border loops as vertex indices, with the surface on the left. Cost: O(n), and O(b log b) of b border
/// edges.
[[nodiscard]] std::vector<std::vector<VertexIndex>> border_loops_of(
    const Mesh& mesh, const std::vector<std::array<FaceIndex, 3>>& neighbours);

/// Returns the largest distance between two corners of a loop in mm. Cost: O(n²).
[[nodiscard]] double width_of_loop(const Mesh& mesh, const std::vector<VertexIndex>& loop);

}  // namespace triskin::mesh
