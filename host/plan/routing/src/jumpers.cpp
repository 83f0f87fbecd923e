// SPDX-License-Identifier: GPL-3.0-or-later
#include "triskin/routing/jumpers.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <set>
#include <span>

#include "triskin/base/index.hpp"
#include "triskin/routing/jumper_sides.hpp"

namespace triskin::routing {
namespace {

constexpr double kRounding_mm = 1e-9;  // This covers the rounding error of 32 steps.
constexpr int kSteps = 32;             // We measure the length of a jumper in this many steps.
constexpr double kLayer_mm = 10.0;     // A jumper does not cross a module that lies farther off along the normal.
constexpr double kReach_mm = 17.4;     // The corners of a module are this far from its centroid.

Vec3 normal_of(const std::array<Vec3, 3>& t) {
  return (t[1] - t[0]).cross(t[2] - t[0]).normalized();
}

// Returns true if the segment has a point that lies more than `depth_mm` inside the module, seen along the module's
// normal.
bool crosses_module(const Vec3& a, const Vec3& b, const std::array<Vec3, 3>& t, double depth_mm) {
  const Vec3 center = (t[0] + t[1] + t[2]) / 3.0, normal = normal_of(t);
  if ((0.5 * (a + b) - center).norm() > kReach_mm + (b - a).norm()) return false;
  if (std::abs(normal.dot(0.5 * (a + b) - center)) > kLayer_mm) return false;
  double from = 0.0, to = 1.0;
  for (std::size_t s = 0; s < 3; ++s) {
    const Vec3 inward = normal.cross(t[(s + 1) % 3] - t[s]).normalized();
    const double at_a = inward.dot(a - t[s]) - depth_mm, at_b = inward.dot(b - t[s]) - depth_mm;
    if (at_a <= 0.0 && at_b <= 0.0) return false;
    const double zero = at_a / (at_a - at_b);
    if (at_a <= 0.0) from = std::max(from, zero);
    if (at_b <= 0.0) to = std::min(to, zero);
  }
  return from < to;
}

struct Segment {
  Vec3 a, b, normal;
};

bool cross(const Segment& p, const Segment& q) {
  const Vec3 n = (p.normal + q.normal).normalized();
  if (p.normal.dot(q.normal) < 0.0 || std::abs(n.dot(p.a + p.b - q.a - q.b)) > 2.0 * kLayer_mm) return false;
  const auto turn = [&](const Vec3& u, const Vec3& v, const Vec3& w) { return n.dot((v - u).cross(w - u)); };
  const bool apart = turn(p.a, p.b, q.a) * turn(p.a, p.b, q.b) > 0.0 || turn(q.a, q.b, p.a) * turn(q.a, q.b, p.b) > 0.0;
  return !apart;
}

class JumperFinder {
 public:
  JumperFinder(const mesh::Surface& surface, const ModuleLayout& layout, const LayoutLimits& limits,
               std::span<const Jumper> fitted)
      : surface_(surface), layout_(layout), limits_(limits), fitted_(fitted) {
    for (std::size_t v = 0; v < layout.modules.size(); ++v) {
      for (std::size_t s = 0; s < 3; ++s) {
        if (layout.modules[v].neighbour[s] < 0)
          sides_.push_back({static_cast<int>(v), static_cast<int>(s), free_side(layout.modules[v].corner_mm, s)});
      }
    }
    std::ranges::stable_sort(sides_, {}, [](const Side& f) { return f.free.middle.x(); });
  }

  std::vector<Jumper> run() {
    std::vector<Jumper> places;
    for (std::size_t a = 0; a < sides_.size(); ++a) {
      for (std::size_t b = a + 1; b < sides_.size(); ++b) {
        if (sides_[b].free.middle.x() - sides_[a].free.middle.x() > limits_.jumper_mm) break;
        if (possible(sides_[a], sides_[b])) places.push_back(jumper(sides_[a], sides_[b]));
      }
    }
    std::erase_if(places, [&](const Jumper& j) { return j.length_mm > limits_.jumper_mm + kRounding_mm; });
    std::ranges::stable_sort(places, {},
                             [&](const Jumper& j) { return std::tuple(!is_fitted(j), j.length_mm, j.node, j.side); });
    return without_conflicts(places);
  }

 private:
  struct Side {
    int node, side;
    FreeSide free;
  };

  [[nodiscard]] bool possible(const Side& a, const Side& b) const {
    const auto &ma = layout_.modules[at(a.node)], &mb = layout_.modules[at(b.node)];
    if (ma.island == mb.island || (b.free.middle - a.free.middle).norm() > limits_.jumper_mm) return false;
    if (!face_each_other(a.free, b.free) || fold_between(a.free, b.free) > limits_.fold_rad) return false;
    return std::ranges::none_of(layout_.modules, [&](const PlacedModule& m) {
      return crosses_module(a.free.middle, b.free.middle, m.corner_mm, limits_.penetration_mm);
    });
  }

  [[nodiscard]] Jumper jumper(const Side& first, const Side& second) const {
    const Side &a = first.node < second.node ? first : second, &b = first.node < second.node ? second : first;
    Jumper j;
    j.node = {a.node, b.node};
    j.side = {a.side, b.side};
    j.length_mm = jumper_length_mm(surface_, a.free.middle, b.free.middle);
    j.fold_rad = fold_between(a.free, b.free);
    return j;
  }

  [[nodiscard]] bool is_fitted(const Jumper& place) const {
    return std::ranges::any_of(fitted_, [&](const Jumper& j) { return j.node == place.node && j.side == place.side; });
  }

  // Takes those in the front first; uses each side and each pair of modules once, and none across another.
  [[nodiscard]] std::vector<Jumper> without_conflicts(const std::vector<Jumper>& places) const {
    std::set<std::array<int, 2>> used_sides, used_pairs;
    std::vector<Segment> segments;
    std::vector<Jumper> chosen;
    for (const Jumper& j : places) {
      const std::array<int, 2> first{j.node[0], j.side[0]}, second{j.node[1], j.side[1]};
      if (used_sides.contains(first) || used_sides.contains(second) || used_pairs.contains(j.node)) continue;
      const Segment segment = segment_of(j);
      if (std::ranges::any_of(segments, [&](const Segment& s) { return cross(s, segment); })) continue;
      used_sides.insert({first, second});
      used_pairs.insert(j.node);
      segments.push_back(segment);
      chosen.push_back(j);
    }
    return chosen;
  }

  [[nodiscard]] Segment segment_of(const Jumper& j) const {
    const auto &a = layout_.modules[at(j.node[0])].corner_mm, &b = layout_.modules[at(j.node[1])].corner_mm;
    return {free_side(a, static_cast<std::size_t>(j.side[0])).middle,
            free_side(b, static_cast<std::size_t>(j.side[1])).middle, (normal_of(a) + normal_of(b)).normalized()};
  }

  const mesh::Surface& surface_;
  const ModuleLayout& layout_;
  const LayoutLimits& limits_;
  std::span<const Jumper> fitted_;
  std::vector<Side> sides_;
};

}  // namespace

double jumper_length_mm(const mesh::Surface& surface, const Vec3& a, const Vec3& b) {
  const Vec3 lift_a = a - surface.closest(a).position_mm, lift_b = b - surface.closest(b).position_mm;
  double length = 0.0;
  Vec3 before = a;
  for (int k = 1; k <= kSteps; ++k) {
    const double t = static_cast<double>(k) / kSteps;
    const Vec3 foot = surface.closest(a + t * (b - a)).position_mm;
    const Vec3 here = foot + (1.0 - t) * lift_a + t * lift_b;
    length += (here - before).norm();
    before = here;
  }
  return length;
}

std::vector<Jumper> find_jumpers(const mesh::Surface& surface, const ModuleLayout& layout, const LayoutLimits& limits,
                                 std::span<const Jumper> fitted) {
  if (!(limits.jumper_mm > 0.0)) return {};
  std::vector<Jumper> places = JumperFinder(surface, layout, limits, fitted).run();
  std::ranges::stable_sort(places, {}, &Jumper::length_mm);
  return places;
}

}  // namespace triskin::routing
