// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <CGAL/AABB_traits.h>
#include <CGAL/AABB_tree.h>
#include <CGAL/AABB_triangle_primitive.h>
#include <CGAL/Simple_cartesian.h>

#include <vector>

#include "checked_design.hpp"

namespace triskin::check {

/// Measures distances to the body of a region with CGAL's tree, independently of the solver's code. Immutable.
class CheckedBody {
 public:
  CheckedBody(const std::vector<P3>& vertices, const std::vector<std::array<int, 3>>& faces);

  /// Returns the least distance of the points of a segment, which is negative inside the body.
  [[nodiscard]] double least_along(const P3& from, const P3& to) const;

 private:
  using Kernel = CGAL::Simple_cartesian<double>;
  using Triangles = std::vector<Kernel::Triangle_3>;
  using Primitive = CGAL::AABB_triangle_primitive<Kernel, Triangles::const_iterator>;

  class NearSegment;
  // Returns the distance of a segment from the triangles; 0 if it meets one.
  [[nodiscard]] double distance(const P3& from, const P3& to) const;
  [[nodiscard]] bool contains(const P3& p) const;
  [[nodiscard]] bool is_inside(const P3& p, const Kernel::Vector_3& ray) const;

  Triangles triangles_;
  bool is_closed_ = false;
  CGAL::AABB_tree<CGAL::AABB_traits<Kernel, Primitive>> tree_;
};

}  // namespace triskin::check
