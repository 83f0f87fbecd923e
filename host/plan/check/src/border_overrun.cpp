// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>
#include <limits>
#include <ranges>
#include <utility>

#include "surface_index.hpp"

namespace triskin::check {
namespace {

constexpr double kTouch_mm = 1e-7;     // Distances to surface and border that differ by less count as equal.
constexpr double kSmallest_mm = 1e-3;  // Parts of a module are not divided below this radius.
// Three halvings at most halve the radius of a part, and a module is at most 120 mm across (surface_rules.cpp), so that
// 3 log2(120 mm / 1 µm) = 51 of them end every branch; a face that divides a part may come between two halvings.
constexpr int kMaxDepth = 128;
constexpr std::size_t kMaxParts = 300'000;  // A module among many sheets needs a hundredth of this.

// A border edge seen from a point.
struct Sight {
  double along;  // The position of the foot runs from 0 at a to 1 at b, clamped.
  P3 off;        // The vector leads from the foot to the point.
  P3 normal;     // The normal of the surface at the foot has unit length.
};

Sight sight_of(const BorderEdge& e, const P3& p) {
  const P3 d = e.b - e.a;
  const double s = std::clamp((p - e.a).dot(d) / d.squaredNorm(), 0.0, 1.0);
  return {s, p - e.a - s * d, ((1 - s) * e.normal_a + s * e.normal_b).normalized()};
}

double across(const P3& off, const P3& normal) {
  return off.cross(normal).norm();
}

// Parts of a module are convex outlines.
double area_in_space(const Outline3& part) {
  P3 twice = P3::Zero();
  for (std::size_t k = 2; k < part.size(); ++k) twice += (part[k - 1] - part[0]).cross(part[k] - part[0]);
  return twice.norm() / 2;
}

// Cuts a part at the plane through p into the near side and the side to which the normal points.
std::array<Outline3, 2> cut(const Outline3& part, const P3& p, const P3& normal) {
  return {clipped(part, p, normal), clipped(part, p, -normal)};
}

// Halves a part across its greatest length.
std::array<Outline3, 2> halved(const Outline3& part, const P3& middle) {
  P3 length = P3::Zero();
  for (const P3& a : part)
    for (const P3& b : part)
      if ((b - a).norm() > length.norm()) length = b - a;
  return cut(part, middle, length);
}

// Divides a part by one face of the surface: `over` is between the planes that stand on the sides of the face, up to
// kTouchingSide_mm past them.
constexpr double kTouchingSide_mm = 1e-6;
struct Division {
  Outline3 over;
  std::vector<Outline3> beside;
};

Division divide_by(const Triangle3& face, Outline3 part) {
  const P3 normal = unit_normal(face);
  Division d;
  for (std::size_t k = 0; k < 3 && part.size() > 2; ++k) {
    const P3 away = (face[(k + 1) % 3] - face[k]).cross(normal).normalized();
    auto [near, far] = cut(part, face[k] + kTouchingSide_mm * away, away);
    if (area_in_space(far) > 0.0) d.beside.push_back(std::move(far));
    part = std::move(near);
  }
  d.over = std::move(part);
  return d;
}

// Runs branch and bound over convex parts of one module; points count that are past the border by `past_mm`, or lack no
// more than its negative.
class OverrunSearch {
 public:
  OverrunSearch(const SurfaceIndex& surface, double past_mm)
      : surface_(surface), past_mm_(past_mm), lack_mm_(std::max(0.0, -past_mm)) {}

  Overrun run(const Outline3& module) {
    const std::size_t n = module.size();
    P3 c = P3::Zero();
    for (const P3& corner : module) c += corner / static_cast<double>(n);
    double radius = 0.0;
    for (const P3& corner : module) radius = std::max(radius, (corner - c).norm());
    const double reach = surface_.distance(c) + 2.0 * radius;
    std::vector<const BorderEdge*> near;
    for (const BorderEdge& e : surface_.border()) {
      if ((e.a - c).norm() <= reach + (e.b - e.a).norm() && sight_of(e, c).off.norm() <= reach) near.push_back(&e);
    }
    if (near.empty()) return {};
    for (std::size_t k = 0; k < n; ++k) {  // The largest value is usually found here, which ends the search sooner.
      visit(module[k], surface_.distance(module[k]), near);
      const P3 middle = (module[k] + module[(k + 1) % n]) / 2;
      visit(middle, surface_.distance(middle), near);
    }
    divide(module, near, 0);
    if (is_cut_off_) best_ = std::numeric_limits<double>::infinity();
    return {best_, points_};
  }

 private:
  void visit(const P3& p, double to_surface, const std::vector<const BorderEdge*>& near) {
    ++points_;
    double nearest = std::numeric_limits<double>::infinity(), over = 0.0, past = 0.0;
    for (const BorderEdge* e : near) {
      const Sight s = sight_of(*e, p);
      const double distance = s.off.norm(), out = s.off.dot(e->out);
      if (distance > nearest + kTouch_mm) continue;
      past =
          std::abs(distance - nearest) <= kTouch_mm ? std::max(past, out) : out;  // At a corner two edges are nearest.
      if (distance >= nearest) continue;
      nearest = distance;
      over = across(s.off, s.normal);
    }
    const double touch = std::hypot(to_surface, lack_mm_) - to_surface + kTouch_mm;
    if (nearest <= to_surface + touch && past >= past_mm_) best_ = std::max(best_, over);
  }

  static bool are_all_at(double along, const std::vector<Sight>& sights) {
    return std::ranges::all_of(sights, [along](const Sight& s) { return s.along == along; });
  }

  // Bounds the overrun of all points of the part while the edge is the nearest of the surface. The foot slides no
  // farther than the point, the distance to a point or a line is convex, and the normal turns by at most `turn` per mm.
  [[nodiscard]] double bound(const BorderEdge& e, const Outline3& part, const P3& middle, double radius) const {
    const double length = (e.b - e.a).norm(), slack = radius / length;
    const Sight s = sight_of(e, middle);
    const bool inside = s.along > slack && s.along < 1.0 - slack;
    if (inside && s.off.dot(e.out) < past_mm_ - radius) return 0.0;  // The face of the edge is nearer, or too near.
    const double turn =
        (e.normal_b - e.normal_a).norm() / (length * std::max(0.1, (e.normal_a + e.normal_b).norm() / 2));
    const double turned = turn * radius * (s.off.norm() + radius);
    std::vector<Sight> ends;
    for (const P3& q : part) ends.push_back(sight_of(e, q));
    if (!inside && !are_all_at(0.0, ends) && !are_all_at(1.0, ends)) return across(s.off, s.normal) + radius + turned;
    double most = 0.0;
    for (const Sight& q : ends) most = std::max(most, across(q.off, s.normal));
    return most + turned;
  }

  // Returns true if some point of the part may be as near to the edge as to the surface, of which `foot` is a point.
  // The squared distance to the edge's line less that to the foot is concave, so its least value is at a corner; it
  // must not exceed the tolerance of visit() for touching, and for a second edge that is as near.
  [[nodiscard]] bool may_be_nearest(const BorderEdge& e, const Outline3& part, const P3& foot) const {
    const P3 along = (e.b - e.a).normalized();
    return std::ranges::any_of(part, [&](const P3& q) {
      const double to_foot = (q - foot).norm(), touching = std::hypot(to_foot, lack_mm_) + 2.0 * kTouch_mm;
      return (q - e.a).cross(along).squaredNorm() <= touching * touching;
    });
  }

  // Returns true if the face is close: no point of the part is farther from the surface than its farthest corner is
  // from the face. The border that is nearest to a point which overhangs it is no farther either, so the point is past
  // it by no more.
  [[nodiscard]] bool is_close(std::size_t face, const Outline3& part) const {
    const auto distance = [&](const P3& q) { return surface_.distance_to(face, q); };
    const double far = std::ranges::max(part | std::views::transform(distance)) + 2.0 * kTouch_mm;
    return far <= best_ + kOverrunStep_mm || far < past_mm_;
  }

  // Returns true if the part is between the planes of the face, and no edge of the border that may be nearest leaves
  // the face toward it. An edge at the face's level or behind it is as near as the face only to points straight before
  // the edge, within a band that kTouch_mm and kTouchingSide_mm make: sqrt(4 * 1e-6 * 5) = 0.005 mm for a part 5 mm
  // high.
  [[nodiscard]] bool is_covered(const Triangle3& face, const Outline3& part,
                                const std::vector<const BorderEdge*>& near) const {
    const P3 normal = unit_normal(face);
    if (lack_mm_ > 0.0 || !(normal.norm() > 0.5)) return false;  // A face without area gives no planes.
    const auto height = [&](const P3& q) { return normal.dot(q - face[0]); };
    const auto of_part = std::ranges::minmax(part | std::views::transform(height));
    return std::ranges::none_of(near, [&](const BorderEdge* e) {
      const auto [least, most] = std::minmax({height(e->a), height(e->b)});
      return (of_part.max > kTouchingSide_mm && most > kTouchingSide_mm) ||
             (of_part.min < -kTouchingSide_mm && least < -kTouchingSide_mm);
    });
  }

  void divide(const Outline3& part, const std::vector<const BorderEdge*>& candidates, int depth) {
    if (depth > kMaxDepth || ++parts_ > kMaxParts) is_cut_off_ = true;
    if (is_cut_off_ || part.size() < 3) return;
    P3 m = P3::Zero();
    for (const P3& q : part) m += q / static_cast<double>(part.size());
    double radius = 0.0;
    for (const P3& q : part) radius = std::max(radius, (q - m).norm());
    const auto hit = surface_.closest(m);
    const double to_surface = (m - hit.point).norm();
    std::vector<const BorderEdge*> near;  // These edges may be nearest to a point of the part.
    for (const BorderEdge* e : candidates) {
      if (sight_of(*e, m).off.norm() <= to_surface + 2.0 * radius + lack_mm_ && may_be_nearest(*e, part, hit.point))
        near.push_back(e);
    }
    if (near.empty()) return;
    visit(m, to_surface, near);
    const bool more = std::ranges::any_of(
        near, [&](const BorderEdge* e) { return bound(*e, part, m, radius) > best_ + kOverrunStep_mm; });
    if (!more || radius < kSmallest_mm) return;
    if (is_close(hit.face, part)) return;
    const Triangle3 face = surface_.triangle(hit.face);
    constexpr double kWorth = 0.25;  // Below a quarter of the area, halves find faces that cover more of them.
    const Division by_face = divide_by(face, part);
    if (area_in_space(by_face.over) > kWorth * area_in_space(part) &&
        (is_close(hit.face, by_face.over) || is_covered(face, by_face.over, near))) {
      for (const Outline3& beside : by_face.beside) divide(beside, near, depth + 1);
      return;
    }
    for (const Outline3& half : halved(part, m)) divide(half, near, depth + 1);
  }

  const SurfaceIndex& surface_;
  double past_mm_, lack_mm_;
  double best_ = 0.0;
  std::size_t points_ = 0, parts_ = 0;
  bool is_cut_off_ = false;  // True if the bounds did not close in kMaxParts parts, so the value is unknown.
};

}  // namespace

Overrun overrun_of(const Outline3& module, const SurfaceIndex& surface, double past_mm) {
  return OverrunSearch(surface, past_mm).run(module);
}

}  // namespace triskin::check
