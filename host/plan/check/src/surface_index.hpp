// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <CGAL/AABB_traits.h>
#include <CGAL/AABB_tree.h>
#include <CGAL/AABB_triangle_primitive.h>
#include <CGAL/Simple_cartesian.h>

#include "checked_design.hpp"
#include "module_outline.hpp"

namespace triskin::check {

/// An edge of the surface that has only one face.
struct BorderEdge {
  P3 a, b;
  P3 normal_a, normal_b;  ///< The surface has these unit normals at the ends of the edge.
  P3 out;                 ///< This unit vector lies in the plane of the face, across the edge and away from the face.
};

/// Finds closest points of the mesh of a design. Immutable; refers to the design.
class SurfaceIndex {
 public:
  struct Hit {
    P3 point;
    P3 normal;  ///< The unit normal is interpolated from the corners of the face.
    std::size_t face;
  };

  explicit SurfaceIndex(const CheckedDesign& design);
  [[nodiscard]] Hit closest(const P3& p) const;
  [[nodiscard]] double distance(const P3& p) const;
  [[nodiscard]] double distance_to(std::size_t face, const P3& p) const;
  [[nodiscard]] Triangle3 triangle(std::size_t face) const { return triangle(design_.faces[face]); }
  [[nodiscard]] const std::vector<BorderEdge>& border() const { return border_; }

 private:
  using Kernel = CGAL::Simple_cartesian<double>;
  using Triangles = std::vector<Kernel::Triangle_3>;
  using Primitive = CGAL::AABB_triangle_primitive<Kernel, Triangles::const_iterator>;

  [[nodiscard]] Triangle3 triangle(const std::array<int, 3>& face) const;
  void find_border();

  const CheckedDesign& design_;
  std::vector<P3> normals_;
  Triangles triangles_;
  CGAL::AABB_tree<CGAL::AABB_traits<Kernel, Primitive>> tree_;
  std::vector<BorderEdge> border_;
};

/// Returns how far a module overhangs the border, mm: the largest distance across the normal from a point of its whole
/// area (sides, corners and inside, so holes count too) to the point of the border that is nearest to it, among the
/// points to which no other part of the surface is nearer. By branch and bound with bounds that hold for every point of
/// a part of the module: the value is attained, and no point exceeds it by more than kOverrunStep_mm. Cost: a few
/// hundred closest points if the border is near, some thousand if that of other sheets runs along the surface.
///
/// A point high above the surface that passes the border overhangs it at once by as much as the interpolated normal
/// leans from the face's. A module that leaves the surface by a micrometre therefore has no single meaningful number,
/// but two: the largest over the points that are past the border by `past_mm` = kPast_mm at least, and with -kPast_mm
/// also over those that lack no more to be past it.
inline constexpr double kOverrunStep_mm = 0.002, kPast_mm = 0.02;
/// The recursion is bounded by construction: a module on which the bounds do not close has an infinite overrun.
struct Overrun {
  double mm = 0.0;
  std::size_t points = 0;  ///< This many points of the module were compared with surface and border.
};
[[nodiscard]] Overrun overrun_of(const Outline3& module, const SurfaceIndex& surface, double past_mm);

}  // namespace triskin::check
