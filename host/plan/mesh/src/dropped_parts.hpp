// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <array>
#include <optional>
#include <vector>

#include "triskin/geometry/triangle.hpp"
#include "triskin/mesh/extract.hpp"

namespace triskin::mesh {

[[nodiscard]] geometry::Triangle triangle_of(const Mesh& mesh, FaceIndex face);

/// The triangles of a mesh, for the question whether another mesh has one at the same place to the last bit.
class Triangles {
 public:
  /// Cost: O(n log n).
  explicit Triangles(const Mesh& mesh);
  /// Cost: O(log n).
  [[nodiscard]] bool contains(const geometry::Triangle& t) const;

 private:
  using Key = std::array<std::array<double, 3>, 3>;
  static Key key_of(const geometry::Triangle& t);
  std::vector<Key> keys_;
};

/// Groups the marked faces that share a vertex into parts. Cost: O(n).
[[nodiscard]] std::vector<DroppedPart> parts_of_faces(const Mesh& mesh, const std::vector<bool>& is_dropped);
/// As above for faces of which a share may be missing; none of a face that is all there, while one that is missing can
/// have an area of 0.
[[nodiscard]] std::vector<DroppedPart> parts_of_faces(const Mesh& mesh,
                                                      const std::vector<std::optional<double>>& missing_mm2);

/// Appends to `dropped` the faces of `before` that are not in `after`, as parts. Cost: O(n log n).
void name_dropped(const Mesh& before, const Mesh& after, std::vector<DroppedPart>& dropped);

}  // namespace triskin::mesh
