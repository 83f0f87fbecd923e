// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "triskin/design/design_types.hpp"
#include "triskin/mesh/bvh.hpp"

namespace triskin::mesh {

/// Measures the distance to a body or sheet whose triangles need not form a manifold: screws, motors and other parts of
/// an assembly. Immutable; all queries are const and thread-safe.
class BodyDistance {
 public:
  /// Copies a mesh in mm. The mesh is solid if every edge has an even number of faces; otherwise it is a sheet without
  /// an inside. Cost: O(n log n).
  explicit BodyDistance(Mesh mesh);

  /// Returns the distance of a point, which is negative inside the body. Cost: O(log n) typical.
  [[nodiscard]] double signed_mm(const Vec3& point_mm) const;
  /// Returns the least signed distance of the points from + t · direction (a unit vector), 0 ≤ t ≤ length_mm, at
  /// most 0.1 mm too large. If it exceeds `enough_mm`, the result may be any lower bound above that value. Cost: some
  /// queries where the line goes towards the body or away from it, one for each 0.2 mm where it runs along it.
  [[nodiscard]] double least_along_mm(const Vec3& from_mm, const Vec3& direction, double length_mm,
                                      double enough_mm) const;

 private:
  struct Line {
    Vec3 from, direction;
    double enough_mm;
  };
  struct Probe {  // The signed distance at from + t · direction.
    double t, signed_mm;
  };
  [[nodiscard]] Probe probe_beside(const Line& line, double t, const Probe& known) const;
  void search_between(const Line& line, const Probe& a, const Probe& b, double& least_mm) const;
  // Returns `at_most_mm` if nothing is nearer.
  [[nodiscard]] double distance_mm(const Vec3& point_mm, double at_most_mm) const;
  [[nodiscard]] bool contains(const Vec3& point_mm) const;
  [[nodiscard]] int windings(const Vec3& point_mm, const Vec3& direction) const;

  Mesh mesh_;
  bool is_closed_ = false;
  Bvh tree_;
};

}  // namespace triskin::mesh
