// SPDX-License-Identifier: GPL-3.0-or-later
#include "overrun.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "search_bound.hpp"
#include "triskin/base/index.hpp"
#include "triskin/geometry/triangle.hpp"

namespace triskin::lattice {
namespace {

constexpr double kStep_mm = 0.02;                           // The largest overrun is found with this accuracy.
constexpr double kFineSide_mm = 5e-4, kFineArea_mm = 4e-3;  // Parts that extend no farther are not divided.
constexpr double kTouching_mm = 1e-7;                       // Distances closer than this count as equal.

/// Relates a point of a module to surface and border.
struct Stand {
  mesh::SurfacePoint foot;
  double to_border_mm;
  double across_mm;  ///< The distance from the nearest point of the border is taken across the normal there.
  /// Returns true if the border is the nearest part of the surface: the point then overhangs it by across_mm.
  [[nodiscard]] bool over() const {
    return to_border_mm <= foot.distance_mm + kTouching_mm + rounding_mm(foot.position_mm);
  }
};

/// Bounds the distances of a point by those of another, which makes the searches several times shorter.
struct Near {
  double surface_mm = std::numeric_limits<double>::infinity(), border_mm = surface_mm;

  static Near beside(const Stand& s, double way_mm) {
    const Vec3& place = s.foot.position_mm;
    return {search_bound(s.foot.distance_mm + way_mm, place), search_bound(s.to_border_mm + way_mm, place)};
  }
};

// Returns the path without its component along a unit normal.
double across(const Vec3& way, const Vec3& normal) {
  return (way - way.dot(normal) * normal).norm();
}

Stand stand(const mesh::Surface& surface, const Vec3& p, const Near& near) {
  const mesh::SurfacePoint border = surface.closest_on_border(p, near.border_mm);
  const mesh::SurfacePoint foot = surface.closest(p, near.surface_mm);
  if (border.face < 0) return {foot, border.distance_mm, 0.0};
  return {foot, border.distance_mm, across(p - border.position_mm, surface.normal_at(border))};
}

// Returns the shortest path from p to a point that is as near to some point of an edge as to a point f of the surface;
// b is the edge's nearest point to p. A plane separates the edge's point at t from b; from p it is (|p - b|² + t² -
// |p - f|²) / 2|b + t - f| away, and |b + t - f| <= |b - f| + t. The result is the least over t. This tells a border
// that a sheet passes below from one that ends it: the distances themselves differ by x² / 2z only at the height z.
double way_to_nearer(const Vec3& p, const Vec3& f, const Vec3& b) {
  // Distances near 20 mm that agree to 1e-7 mm have squares that differ by less than this.
  constexpr double kRounding_mm2 = 1e-5;
  const double n = (p - b).squaredNorm() - (p - f).squaredNorm() - kRounding_mm2, d = (b - f).norm();
  return n <= 0.0 ? 0.0 : std::sqrt(d * d + n) - d;
}

/// One face of the surface with the planes through its sides, perpendicular to it.
class FacePrism {
 public:
  // A part may extend past a side by this much, which avoids splinters at the sides.
  static constexpr double kTouch_mm = 1e-6;

  FacePrism(const mesh::Surface& surface, FaceIndex face) : n_(surface.face_normal(face)) {
    const auto& f = surface.mesh().faces[at(face)];
    for (std::size_t k = 0; k < 3; ++k) corner_[k] = surface.mesh().vertices[at(f[k])];
    for (std::size_t k = 0; k < 3; ++k) out_[k] = (corner_[(k + 1) % 3] - corner_[k]).cross(n_).normalized();
  }
  [[nodiscard]] double distance(const Vec3& p) const {
    const Vec3 weights = geometry::closest_on_triangle(p, corner_[0], corner_[1], corner_[2]);
    return (weights[0] * corner_[0] + weights[1] * corner_[1] + weights[2] * corner_[2] - p).norm();
  }
  [[nodiscard]] bool has_area() const { return n_.squaredNorm() > 0.5; }
  [[nodiscard]] double height(const Vec3& p) const { return n_.dot(p - corner_[0]); }
  /// Returns how far p lies past side k, less the allowance.
  [[nodiscard]] double past(std::size_t k, const Vec3& p) const { return out_[k].dot(p - corner_[k]) - kTouch_mm; }

 private:
  std::array<Vec3, 3> corner_, out_;
  Vec3 n_;
};

using Polygon = std::vector<Vec3>;  // All polygons are convex.

// Cuts a convex polygon at a line, given by its signed distance, into the negative and the positive side.
std::pair<Polygon, Polygon> cut(const Polygon& polygon, const auto& distance) {
  Polygon in, out;
  for (std::size_t k = 0; k < polygon.size(); ++k) {
    const Vec3 &p = polygon[k], &q = polygon[(k + 1) % polygon.size()];
    const double at_p = distance(p), at_q = distance(q);
    (at_p <= 0.0 ? in : out).push_back(p);
    if ((at_p <= 0.0) == (at_q <= 0.0)) continue;
    const Vec3 between = p + at_p / (at_p - at_q) * (q - p);
    in.push_back(between);
    out.push_back(between);
  }
  return {in, out};
}

double area_of(std::span<const Vec3> polygon) {
  Vec3 twice = Vec3::Zero();
  for (std::size_t k = 2; k < polygon.size(); ++k)
    twice += (polygon[k - 1] - polygon[0]).cross(polygon[k] - polygon[0]);
  return 0.5 * twice.norm();
}

/// Searches parts of one module and keeps the largest value so far.
class OverrunSearch {
 public:
  OverrunSearch(const mesh::Surface& surface, double known_mm) : surface_(surface), best_{known_mm, 0} {}

  [[nodiscard]] const Overrun& best() const { return best_; }
  void line(const Vec3& from, const Vec3& to) {
    visit(from, {});
    walk(from, to, {});
  }
  void area(const std::array<Vec3, 3>& part, const Near& near = {});

 private:
  Stand visit(const Vec3& p, const Near& near) {
    const Stand s = stand(surface_, p, near);
    if (s.over()) best_.mm = std::max(best_.mm, s.across_mm);
    ++best_.points;
    return s;
  }
  void walk(const Vec3& from, const Vec3& to, const Near& near);
  bool may_exceed(std::span<const Vec3> part, const Vec3& p, const Stand& s, double reach);
  [[nodiscard]] double max_across(const mesh::BorderPoint& b, std::span<const Vec3> part, const Vec3& off,
                                  double reach) const;
  [[nodiscard]] double past_end(const Vec3& end, VertexIndex beyond, const Vec3& way, std::span<const Vec3> part,
                                double from_line) const;
  [[nodiscard]] std::pair<const Vec3&, const Vec3&> ends_of(const mesh::BorderPoint& b) const;
  [[nodiscard]] bool is_close(const FacePrism& face, std::span<const Vec3> part) const;
  [[nodiscard]] bool covers(const FacePrism& face, std::span<const Vec3> part) const;
  [[nodiscard]] std::optional<std::vector<std::array<Vec3, 3>>> beside_face(const Stand& s,
                                                                            const std::array<Vec3, 3>& part) const;

  const mesh::Surface& surface_;
  Overrun best_;
  std::vector<mesh::BorderPoint> near_;  // These border points lie near the point of the last may_exceed().
};

// Returns true if a part of the module, all within `reach` of a point, may overhang the border by more than is known.
// The distances to the surface and to an edge change by no more than the path of the point, so an edge that is nearest
// to some point of the part lies within twice the reach of being nearest here; the part may lie under another sheet of
// the surface, so it need not be the nearest one here. Of two edges at a corner one passes the test of the side.
bool OverrunSearch::may_exceed(std::span<const Vec3> part, const Vec3& p, const Stand& s, double reach) {
  if (s.to_border_mm - s.foot.distance_mm > 2.0 * reach) return false;
  near_.clear();
  surface_.border_within(p, s.foot.distance_mm + 2.0 * reach + kTouching_mm, near_);
  return std::ranges::any_of(near_, [&](const mesh::BorderPoint& b) {
    if (way_to_nearer(p, s.foot.position_mm, b.point.position_mm) > reach) return false;
    const Vec3 off = p - b.point.position_mm;
    if (max_across(b, part, off, reach) <= best_.mm + kStep_mm) return false;
    const auto [from, to] = ends_of(b);
    const Vec3 out = (to - from).cross(surface_.face_normal(b.point.face)).normalized();
    return off.dot(out) >= -2.0 * reach;
  });
}

// Bounds the distance across the normal from an edge to those points of a part whose nearest border is the edge; `off`
// leads to its middle from the edge's point b. A point that just leaves the surface may at once overhang the border by
// as much as the normals of vertices are turned from the face's: such slivers are searched for. The reach counts three
// times, since the normal turns along the border too. The distance across a fixed normal is largest at a corner; the
// turn of the normal is added.
double OverrunSearch::max_across(const mesh::BorderPoint& b, std::span<const Vec3> part, const Vec3& off,
                                 double reach) const {
  const Vec3 n = surface_.normal_at(b.point);
  const auto [from, to] = ends_of(b);
  const Vec3 edge = to - from;
  const double around = across(off, n) + 3.0 * reach;
  if (!(edge.squaredNorm() > 0.0)) return around;
  double at_corners = 0.0, from_line = 0.0;
  for (const Vec3& q : part) {
    const Vec3 way = q - from - (q - from).dot(edge) / edge.squaredNorm() * edge;
    at_corners = std::max(at_corners, across(way, n));
    from_line = std::max(from_line, way.norm());
  }
  const double past_from = past_end(from, b.beyond[0], -edge, part, from_line),
               past_to = past_end(to, b.beyond[1], edge, part, from_line);
  if (past_from < 0.0 || past_to < 0.0) return 0.0;
  const auto& f = surface_.mesh().faces[at(b.point.face)];
  const auto normal_of = [&](int k) -> const Vec3& { return surface_.vertex_normal(VertexIndex(f[at(k % 3)])); };
  const Vec3 &n_from = normal_of(b.side), &n_to = normal_of(b.side + 1);
  // The interpolated normals are shortest in the middle, as the normals at the ends are units.
  const double shortest = 0.5 * (n_from + n_to).norm();
  if (!(shortest > 0.5)) return around;
  const double turned = (n_to - n_from).norm() / (edge.norm() * shortest) * reach * (off.norm() + reach);
  return std::min(around, at_corners + std::max(past_from, past_to) + turned);
}

// Bounds how far past an end of an edge, along it, a point of a part may be if the end is nearest to it: the border
// continues there, and the end is nearest only between the planes across both edges. So the bound is the distance from
// the line times the tangent of their angle; infinite at a sharp corner. A negative value means that the border beyond
// is nearer to all of the part.
double OverrunSearch::past_end(const Vec3& end, VertexIndex beyond, const Vec3& way, std::span<const Vec3> part,
                               double from_line) const {
  const Vec3 next = (surface_.mesh().vertices[at(beyond)] - end).normalized();
  const auto past = [&](const Vec3& q) { return way.dot(q - end) > 0.0; };
  if (std::ranges::none_of(part, past)) return 0.0;
  if (std::ranges::all_of(part, [&](const Vec3& q) { return past(q) && next.dot(q - end) > 0.0; })) return -1.0;
  const double cosine = next.dot(way) / way.norm();
  if (cosine < 0.5) return std::numeric_limits<double>::infinity();
  return from_line * std::sqrt(std::max(0.0, 1.0 - cosine * cosine)) / cosine;
}

std::pair<const Vec3&, const Vec3&> OverrunSearch::ends_of(const mesh::BorderPoint& b) const {
  const auto& face = surface_.mesh().faces[at(b.point.face)];
  const auto corner = [&](int k) -> const Vec3& { return surface_.mesh().vertices[at(face[at(k % 3)])]; };
  return {corner(b.side), corner(b.side + 1)};
}

// Returns true if a single face shows that no point of a part can overhang the border by more than is known. The part
// then need not be divided where a border runs along the surface, as that of another sheet that ends there. The surface
// is no farther than the face, and the distance to a face is largest at a corner of the part, so no point overhangs a
// border by more.
bool OverrunSearch::is_close(const FacePrism& face, std::span<const Vec3> part) const {
  return std::ranges::all_of(
      part, [&](const Vec3& p) { return face.distance(p) + 2.0 * kTouching_mm <= best_.mm + kStep_mm; });
}

// Does the same for a part between the planes of the face, at any height. A border that does not rise from the face
// toward the part is nearer than the face only to points within sqrt(4 * kTouch_mm * height), 5 µm at 5 mm, of the
// line under them: a band as narrow as parts that are not divided.
bool OverrunSearch::covers(const FacePrism& face, std::span<const Vec3> part) const {
  if (!face.has_area()) return false;
  double low = std::numeric_limits<double>::infinity(), high = -low;
  for (const Vec3& p : part) {
    low = std::min(low, face.height(p));
    high = std::max(high, face.height(p));
  }
  const auto rises = [&](const Vec3& end) {
    const double h = face.height(end);
    return (high > FacePrism::kTouch_mm && h > FacePrism::kTouch_mm) ||
           (low < -FacePrism::kTouch_mm && h < -FacePrism::kTouch_mm);
  };
  return std::ranges::none_of(near_, [&](const mesh::BorderPoint& b) {
    const auto [from, to] = ends_of(b);
    return rises(from) || rises(to);
  });
}

// Returns the parts that lie beside the face under the middle, when the face covers the rest and that is worth a cut.
// Splinters thinner than the allowance past a side are left to the face.
std::optional<std::vector<std::array<Vec3, 3>>> OverrunSearch::beside_face(const Stand& s,
                                                                           const std::array<Vec3, 3>& part) const {
  constexpr double kWorth = 0.25;  // A division is worth it only if more than a quarter of the area lies over the face.
  const FacePrism face(surface_, s.foot.face);
  if (is_close(face, part)) return std::vector<std::array<Vec3, 3>>{};
  Polygon over(part.begin(), part.end());
  std::vector<std::array<Vec3, 3>> beside;
  for (std::size_t k = 0; k < 3 && !over.empty(); ++k) {
    auto [in, out] = cut(over, [&](const Vec3& p) { return face.past(k, p); });
    for (std::size_t c = 2; c < out.size(); ++c) {
      const std::array piece{out[0], out[c - 1], out[c]};
      if (2.0 * area_of(piece) > FacePrism::kTouch_mm * (piece[1] - piece[0]).norm()) beside.push_back(piece);
    }
    over = std::move(in);
  }
  if (area_of(over) <= kWorth * area_of(part) || !(is_close(face, over) || covers(face, over))) return std::nullopt;
  return beside;
}

void OverrunSearch::walk(const Vec3& from, const Vec3& to, const Near& near) {
  const Vec3 middle = 0.5 * (from + to), way = to - from;
  const double reach = 0.5 * way.norm();
  const Stand s = visit(middle, near);
  const std::array line{from, to};
  if (reach < kFineSide_mm || !may_exceed(line, middle, s, reach)) return;
  const FacePrism face(surface_, s.foot.face);
  if (is_close(face, line)) return;
  double first = 0.0, last = 1.0;  // The range of the path that lies over the face.
  for (std::size_t k = 0; k < 3; ++k) {
    const double at_from = face.past(k, from), at_to = face.past(k, to);
    if (at_from > 0.0 && at_to > 0.0) last = 0.0;
    if (at_from <= 0.0 && at_to > 0.0) last = std::min(last, at_from / (at_from - at_to));
    if (at_from > 0.0 && at_to <= 0.0) first = std::max(first, at_from / (at_from - at_to));
  }
  const std::array over{Vec3(from + first * way), Vec3(from + last * way)};
  constexpr double kWorth = 0.5;  // A division is worth it only if half of the path lies over the face.
  const Near beside = Near::beside(s, reach);
  if (last - first >= kWorth && (is_close(face, over) || covers(face, over))) {
    if (first > 0.0) walk(from, over[0], beside);
    if (last < 1.0) walk(over[1], to, beside);
    return;
  }
  const Near half = Near::beside(s, 0.5 * reach);
  walk(from, middle, half);
  walk(middle, to, half);
}

// Does the same over the area, to find notches and holes of the border under the module.
void OverrunSearch::area(const std::array<Vec3, 3>& part, const Near& near) {
  const Vec3 middle = (part[0] + part[1] + part[2]) / 3.0;
  double reach = 0.0;
  for (const Vec3& p : part) reach = std::max(reach, (p - middle).norm());
  const Stand s = visit(middle, near);
  if (reach < kFineArea_mm || !may_exceed(part, middle, s, reach)) return;
  if (const auto beside = beside_face(s, part)) {
    for (const auto& p : *beside) area(p, Near::beside(s, reach));
    return;
  }
  std::size_t k = 0;  // The longest side is divided so that thin parts do not stay thin.
  for (const std::size_t other : {1UL, 2UL})
    if ((part[(other + 1) % 3] - part[other]).norm() > (part[(k + 1) % 3] - part[k]).norm()) k = other;
  const Vec3 &a = part[k], &b = part[(k + 1) % 3], &c = part[(k + 2) % 3], ab = 0.5 * (a + b);
  area({a, ab, c}, Near::beside(s, reach));
  area({ab, b, c}, Near::beside(s, reach));
}

}  // namespace

Overrun overrun_of_line(const mesh::Surface& surface, const Vec3& from, const Vec3& to, double known_mm) {
  OverrunSearch search(surface, known_mm);
  search.line(from, to);
  return search.best();
}

Overrun overrun_of(const mesh::Surface& surface, const design::Outline& outline) {
  OverrunSearch search(surface, 0.0);
  const auto points = outline.points();
  for (std::size_t s = 0; s < points.size(); ++s) search.line(points[s], points[(s + 1) % points.size()]);
  for (std::size_t k = 1; k + 1 < points.size(); ++k) search.area({points[0], points[k], points[k + 1]});
  return search.best();
}

}  // namespace triskin::lattice
