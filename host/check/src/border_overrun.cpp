// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>
#include <limits>

#include "surface_index.hpp"

namespace triskin::check {
namespace {

constexpr double kTouch_mm = 1e-7;     // distances to surface and border that count as equal
constexpr double kSmallest_mm = 1e-3;  // parts of a module are not divided below this radius

// A border edge seen from a point.
struct Sight {
  double along;  // of the foot: 0 at a, 1 at b, clamped
  P3 off;        // from the foot to the point
  P3 normal;     // of the surface at the foot, unit
};

Sight sight_of(const BorderEdge& e, const P3& p) {
  const P3 d = e.b - e.a;
  const double s = std::clamp((p - e.a).dot(d) / d.squaredNorm(), 0.0, 1.0);
  return {s, p - e.a - s * d, ((1 - s) * e.normal_a + s * e.normal_b).normalized()};
}

double across(const P3& off, const P3& normal) {
  return off.cross(normal).norm();
}

// Branch and bound over parts of one module; points count that are past the border by `past_mm`, or lack no more than
// its negative.
class OverrunSearch {
 public:
  OverrunSearch(const SurfaceIndex& surface, double past_mm)
      : surface_(surface), past_mm_(past_mm), lack_mm_(std::max(0.0, -past_mm)) {}

  double run(const Outline3& module) {
    const std::size_t n = module.size();
    P3 c = P3::Zero();
    for (const P3& corner : module) c += corner / static_cast<double>(n);
    double radius = 0.0;
    for (const P3& corner : module) radius = std::max(radius, (corner - c).norm());
    const double reach = surface_.distance(c) + 2.0 * radius;
    std::vector<const BorderEdge*> near;
    for (const BorderEdge& e : surface_.border()) {
      if (sight_of(e, c).off.norm() <= reach) near.push_back(&e);
    }
    if (near.empty()) return 0.0;
    for (std::size_t k = 0; k < n; ++k) {  // where the largest value is mostly found: the search then ends sooner
      visit(module[k], surface_.distance(module[k]), near);
      const P3 middle = (module[k] + module[(k + 1) % n]) / 2;
      visit(middle, surface_.distance(middle), near);
    }
    for (std::size_t k = 1; k + 1 < n; ++k) divide({module[0], module[k], module[k + 1]}, near);
    return best_;
  }

 private:
  void visit(const P3& p, double to_surface, const std::vector<const BorderEdge*>& near) {
    double nearest = std::numeric_limits<double>::infinity(), over = 0.0, past = 0.0;
    for (const BorderEdge* e : near) {
      const Sight s = sight_of(*e, p);
      const double distance = s.off.norm(), out = s.off.dot(e->out);
      if (distance > nearest + kTouch_mm) continue;
      past =
          std::abs(distance - nearest) <= kTouch_mm ? std::max(past, out) : out;  // at a corner two edges are nearest
      if (distance >= nearest) continue;
      nearest = distance;
      over = across(s.off, s.normal);
    }
    const double touch = std::hypot(to_surface, lack_mm_) - to_surface + kTouch_mm;
    if (nearest <= to_surface + touch && past >= past_mm_) best_ = std::max(best_, over);
  }

  // No point within the part exceeds this while the edge is the nearest of the surface. The foot slides no farther than
  // the point, the distance to a point or a line is convex, and the normal turns by at most `turn` a mm.
  [[nodiscard]] double bound(const BorderEdge& e, const Triangle3& part, const P3& middle, double radius) const {
    const double length = (e.b - e.a).norm(), slack = radius / length;
    const Sight s = sight_of(e, middle);
    const bool inside = s.along > slack && s.along < 1.0 - slack;
    if (inside && s.off.dot(e.out) < past_mm_ - radius) return 0.0;  // the face of the edge is nearer, or too near
    const double turn =
        (e.normal_b - e.normal_a).norm() / (length * std::max(0.1, (e.normal_a + e.normal_b).norm() / 2));
    const double turned = turn * radius * (s.off.norm() + radius);
    const Sight ends[3] = {sight_of(e, part[0]), sight_of(e, part[1]), sight_of(e, part[2])};
    const auto all_at = [&](double end) {
      return std::ranges::all_of(ends, [end](const Sight& q) { return q.along == end; });
    };
    if (!inside && !all_at(0.0) && !all_at(1.0)) return across(s.off, s.normal) + radius + turned;
    double most = 0.0;
    for (const Sight& q : ends) most = std::max(most, across(q.off, s.normal));
    return most + turned;
  }

  // Some point of the part may be as near to the edge as to the surface, of which `foot` is a point. The squared
  // distance to the edge's line less that to the foot is concave, so its least value is at a corner; it must not exceed
  // what visit() takes for touching, and a second edge that is as near.
  [[nodiscard]] bool may_be_nearest(const BorderEdge& e, const Triangle3& part, const P3& foot) const {
    const P3 along = (e.b - e.a).normalized();
    return std::ranges::any_of(part, [&](const P3& q) {
      const double to_foot = (q - foot).norm(), touching = std::hypot(to_foot, lack_mm_) + 2.0 * kTouch_mm;
      return (q - e.a).cross(along).squaredNorm() <= touching * touching;
    });
  }

  void divide(const Triangle3& part, const std::vector<const BorderEdge*>& candidates) {
    const P3 m = centroid(part);
    const double radius = std::max({(part[0] - m).norm(), (part[1] - m).norm(), (part[2] - m).norm()});
    const P3 foot = surface_.closest(m).point;
    const double to_surface = (m - foot).norm();
    std::vector<const BorderEdge*> near;  // all that may be nearest to a point of the part
    for (const BorderEdge* e : candidates) {
      if (sight_of(*e, m).off.norm() <= to_surface + 2.0 * radius + lack_mm_ && may_be_nearest(*e, part, foot))
        near.push_back(e);
    }
    if (near.empty()) return;
    visit(m, to_surface, near);
    const bool more = std::ranges::any_of(
        near, [&](const BorderEdge* e) { return bound(*e, part, m, radius) > best_ + kOverrunStep_mm; });
    if (!more || radius < kSmallest_mm) return;
    const P3 ab = (part[0] + part[1]) / 2, bc = (part[1] + part[2]) / 2, ca = (part[2] + part[0]) / 2;
    divide({part[0], ab, ca}, near);
    divide({part[1], bc, ab}, near);
    divide({part[2], ca, bc}, near);
    divide({ab, bc, ca}, near);
  }

  const SurfaceIndex& surface_;
  double past_mm_, lack_mm_;
  double best_ = 0.0;
};

}  // namespace

double overrun_of(const Outline3& module, const SurfaceIndex& surface, double past_mm) {
  return OverrunSearch(surface, past_mm).run(module);
}

}  // namespace triskin::check
