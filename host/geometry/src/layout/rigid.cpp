// SPDX-License-Identifier: GPL-3.0-or-later
#include "rigid.hpp"

#include <Eigen/Geometry>
#include <Eigen/SVD>
#include <algorithm>
#include <cmath>
#include <limits>

#include "triskin/geometry/design_types.hpp"

namespace triskin::geometry {

std::array<Vec3, 3> fit_rigid(const std::array<Vec3, 3>& target) {
  static const std::array<Vec3, 3> kRest{Vec3(-15, -kHeight_mm / 3, 0), Vec3(15, -kHeight_mm / 3, 0),
                                         Vec3(0, 2 * kHeight_mm / 3, 0)};
  const Vec3 center = (target[0] + target[1] + target[2]) / 3.0;
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
  for (std::size_t k = 0; k < 3; ++k) covariance += (target[k] - center) * kRest[k].transpose();
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(covariance, Eigen::ComputeFullU | Eigen::ComputeFullV);
  Eigen::Vector3d sign(1, 1, (svd.matrixU() * svd.matrixV().transpose()).determinant() < 0 ? -1 : 1);
  const Eigen::Matrix3d rotation = svd.matrixU() * sign.asDiagonal() * svd.matrixV().transpose();
  return {Vec3(center + rotation * kRest[0]), Vec3(center + rotation * kRest[1]), Vec3(center + rotation * kRest[2])};
}

namespace {

constexpr double kStep_mm = 0.02;                           // the largest overrun is found to this
constexpr double kFineSide_mm = 5e-4, kFineArea_mm = 4e-3;  // parts that reach no farther are not divided

/// A point of a module over surface and border.
struct Stand {
  SurfacePoint foot;
  double to_border_mm;
  double across_mm;  ///< from the nearest point of the border, across the normal there
  /// The border is the nearest of the surface: the point stands over it by across_mm.
  [[nodiscard]] bool over() const { return to_border_mm <= foot.distance_mm + 1e-7; }
};

// A bound for searches that a distance itself lies within.
double at_most(double distance_mm) {
  return (1.0 + 1e-9) * distance_mm + 1e-9;
}

/// What the distances of a point cannot exceed, from those of another: the searches are several times as short.
struct Near {
  double surface_mm = std::numeric_limits<double>::infinity(), border_mm = surface_mm;

  static Near beside(const Stand& s, double way_mm) {
    return {at_most(s.foot.distance_mm + way_mm), at_most(s.to_border_mm + way_mm)};
  }
};

Stand stand(const Surface& surface, const Vec3& p, const Near& near) {
  const SurfacePoint border = surface.closest_on_border(p, near.border_mm);
  const SurfacePoint foot = surface.closest(p, near.surface_mm);
  if (border.face < 0) return {foot, border.distance_mm, 0.0};
  const Vec3 off = p - border.position_mm, n = surface.normal_at(border);
  return {foot, border.distance_mm, (off - off.dot(n) * n).norm()};
}

Stand visit(const Surface& surface, const Vec3& p, double& best, const Near& near = {}) {
  const Stand s = stand(surface, p, near);
  if (s.over()) best = std::max(best, s.across_mm);
  return s;
}

// The least way from p to a point that is as near to some point of an edge as to a point f of the surface; b is the
// edge's nearest to p. For the edge's point at t from b the two are parted by a plane; from p it is
// (|p - b|² + t² - |p - f|²) / 2|b + t - f| off, and |b + t - f| <= |b - f| + t. Least over t. A border that a sheet
// passes below is told from one that ends it: the distances themselves differ by x² / 2z only at the height z.
double way_to_nearer(const Vec3& p, const Vec3& f, const Vec3& b) {
  constexpr double kRounding_mm2 = 1e-5;  // of distances equal to 1e-7 mm, some 20 mm long
  const double n = (p - b).squaredNorm() - (p - f).squaredNorm() - kRounding_mm2, d = (b - f).norm();
  return n <= 0.0 ? 0.0 : std::sqrt(d * d + n) - d;
}

// Whether a part of the module, all within `reach` of a point, may stand over the border by more than is known. The
// distances to the surface and to an edge change by no more than the way of the point, so an edge that is nearest to
// some point of the part lies within twice the reach of being nearest here; the part may lie under another sheet of the
// surface, so that it need not be the nearest one here. A point that just leaves the surface may at once stand over the
// border by as much as the normals of vertices are turned from the face's: such slivers are searched for. Three: the
// normal turns along the border, too. Of two edges at a corner one passes the test of the side.
bool may_exceed(const Surface& surface, const Vec3& p, const Stand& s, double reach, double known_mm) {
  if (s.to_border_mm - s.foot.distance_mm > 2.0 * reach) return false;
  static thread_local std::vector<BorderPoint> near;
  near.clear();
  surface.border_within(p, s.foot.distance_mm + 2.0 * reach + 1e-7, near);
  return std::ranges::any_of(near, [&](const BorderPoint& b) {
    if (way_to_nearer(p, s.foot.position_mm, b.point.position_mm) > reach) return false;
    const Vec3 off = p - b.point.position_mm, n = surface.normal_at(b.point);
    if ((off - off.dot(n) * n).norm() + 3.0 * reach <= known_mm + kStep_mm) return false;
    const auto& face = surface.mesh().faces[static_cast<std::size_t>(b.point.face)];
    const auto corner = [&](int k) -> const Vec3& {
      return surface.mesh().vertices[static_cast<std::size_t>(face[static_cast<std::size_t>(k % 3)])];
    };
    const Vec3 out = (corner(b.side + 1) - corner(b.side)).cross(surface.face_normal(b.point.face)).normalized();
    return off.dot(out) >= -2.0 * reach;
  });
}

void walk_over_border(const Surface& surface, const Vec3& from, const Vec3& to, double& best, const Near& near = {}) {
  const Vec3 middle = 0.5 * (from + to);
  const double reach = 0.5 * (to - from).norm();
  const Stand s = visit(surface, middle, best, near);
  if (reach < kFineSide_mm || !may_exceed(surface, middle, s, reach, best)) return;
  const Near beside = Near::beside(s, 0.5 * reach);
  walk_over_border(surface, from, middle, best, beside);
  walk_over_border(surface, middle, to, best, beside);
}

// The same over the area: notches and holes of the border under the module.
void search_over_border(const Surface& surface, const std::array<Vec3, 3>& part, double reach, double& best,
                        const Near& near = {}) {
  const Vec3 middle = (part[0] + part[1] + part[2]) / 3.0;
  const Stand s = visit(surface, middle, best, near);
  if (reach < kFineArea_mm || !may_exceed(surface, middle, s, reach, best)) return;
  const Vec3 ab = 0.5 * (part[0] + part[1]), bc = 0.5 * (part[1] + part[2]), ca = 0.5 * (part[2] + part[0]);
  for (const auto& quarter : {std::array{part[0], ab, ca}, std::array{part[1], bc, ab}, std::array{part[2], ca, bc},
                              std::array{ab, bc, ca}}) {
    search_over_border(surface, quarter, 0.5 * reach, best, Near::beside(s, 0.5 * reach));
  }
}

}  // namespace

SideHeights walk_sides(const Surface& surface, const design::Outline& outline, double step_mm) {
  SideHeights h;
  const auto corners = outline.points();
  const std::size_t n = corners.size();
  SurfacePoint c = surface.closest(corners[0]);
  for (std::size_t s = 0; s < n; ++s) {
    const Vec3 side = corners[(s + 1) % n] - corners[s];
    const int samples = std::max(1, static_cast<int>(std::lround(side.norm() / step_mm)));
    for (int k = 0; k < samples; ++k) {
      const Vec3 p = corners[s] + side * (static_cast<double>(k) / samples);
      c = surface.closest(p, at_most((p - c.position_mm).norm()));
      const double height = (p - c.position_mm).dot(surface.normal_at(c));
      h.lift_mm = std::max(h.lift_mm, height);
      h.depth_mm = std::max(h.depth_mm, -height);
    }
  }
  return h;
}

double overrun_of_line(const Surface& surface, const Vec3& from, const Vec3& to, double known_mm) {
  visit(surface, from, known_mm);
  walk_over_border(surface, from, to, known_mm);
  return known_mm;
}

double overrun_of(const Surface& surface, const design::Outline& outline) {
  double known_mm = 0.0;
  const auto search = [&](const std::array<Vec3, 3>& part) {
    const Vec3 c = (part[0] + part[1] + part[2]) / 3.0;
    double reach = 0.0;
    for (const Vec3& p : part) reach = std::max(reach, (p - c).norm());
    search_over_border(surface, part, reach, known_mm);
  };
  const auto points = outline.points();
  for (std::size_t s = 0; s < points.size(); ++s)
    known_mm = overrun_of_line(surface, points[s], points[(s + 1) % points.size()], known_mm);
  for (std::size_t k = 1; k + 1 < points.size(); ++k) search({points[0], points[k], points[k + 1]});
  return known_mm;
}

Vec3 held_to_surface(const Surface& surface, const Vec3& p, double overhang_mm, Vec3& foot) {
  const SurfacePoint found = surface.closest(p, at_most((p - foot).norm()));
  foot = found.position_mm;
  if (overhang_mm <= 0.0 || !(surface.border_distance(foot) <= 1e-6)) return foot;
  const Vec3 off = p - foot, n = surface.normal_at(found), over = off - off.dot(n) * n;
  const double length = over.norm();
  return length <= overhang_mm ? Vec3(foot + over) : Vec3(foot + overhang_mm / length * over);
}

}  // namespace triskin::geometry
