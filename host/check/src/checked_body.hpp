// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <CGAL/AABB_traits.h>
#include <CGAL/AABB_tree.h>
#include <CGAL/AABB_triangle_primitive.h>
#include <CGAL/Simple_cartesian.h>

#include <vector>

#include "triskin/check/checked_design.hpp"

namespace triskin::check {

/// The body of a region, as the checker measures it: by CGAL's tree, without code of the solver. Immutable.
class CheckedBody {
 public:
  CheckedBody(const std::vector<P3>& vertices, const std::vector<std::array<int, 3>>& faces);

  /// Least distance, negative inside, of the points of a segment.
  [[nodiscard]] double least_along(const P3& from, const P3& to) const;

 private:
  using Kernel = CGAL::Simple_cartesian<double>;
  using Triangles = std::vector<Kernel::Triangle_3>;
  using Primitive = CGAL::AABB_triangle_primitive<Kernel, Triangles::const_iterator>;

  [[nodiscard]] bool contains(const P3& p) const;
  [[nodiscard]] bool is_inside(const P3& p, const Kernel::Vector_3& ray) const;

  Triangles triangles_;
  bool is_closed_ = false;
  CGAL::AABB_tree<CGAL::AABB_traits<Kernel, Primitive>> tree_;
};

}  // namespace triskin::check
