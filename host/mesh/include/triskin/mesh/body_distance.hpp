// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "triskin/design/design_types.hpp"
#include "triskin/mesh/bvh.hpp"

namespace triskin::geometry {

/// Distance to a body, or to a sheet, that is given by triangles which need not be a manifold: screws, motors, other
/// parts of an assembly. Immutable; all queries are const and thread-safe.
class BodyDistance {
 public:
  /// Takes a mesh in mm, which is copied. Its inside counts as the body where each edge has an even number of faces;
  /// otherwise it is a sheet. Cost: O(n log n).
  explicit BodyDistance(Mesh mesh);

  /// Distance of a point, negative inside the body. Cost: O(log n) typical.
  [[nodiscard]] double signed_mm(const Vec3& point_mm) const;
  /// Least signed distance of the points from + t · direction (a unit vector), 0 ≤ t ≤ length_mm, found to 0.1 mm
  /// above it at most. Where it is over `enough_mm`, a lower bound that is over it too comes back. Cost: one query for
  /// each 0.1 mm along the body, fewer away from it.
  [[nodiscard]] double least_along_mm(const Vec3& from_mm, const Vec3& direction, double length_mm,
                                      double enough_mm) const;

 private:
  [[nodiscard]] double distance_mm(const Vec3& point_mm) const;
  [[nodiscard]] bool contains(const Vec3& point_mm) const;
  [[nodiscard]] int windings(const Vec3& point_mm, const Vec3& direction) const;

  Mesh mesh_;
  bool is_closed_ = false;
  Bvh tree_;
};

}  // namespace triskin::geometry
