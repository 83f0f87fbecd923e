// SPDX-License-Identifier: GPL-3.0-or-later
#include "outline.hpp"

#include <fmt/format.h>

#include <limits>

#include "triskin/base/error.hpp"
#include "triskin/geometry/segment.hpp"
#include "triskin/placement/polygon_io.hpp"

namespace triskin::placement {
namespace {

bool is_inside(const std::vector<Vec2>& ring, const Vec2& p) {
  bool inside = false;
  for (std::size_t k = 0; k < ring.size(); ++k) {
    if (geometry::ray_crosses(p, ring[k], ring[(k + 1) % ring.size()])) inside = !inside;
  }
  return inside;
}

}  // namespace

void Outline::cubic_to(const Vec2& a, const Vec2& b, const Vec2& p) {
  const Vec2 from = end();
  const double bend_mm = 6.0 * std::max((from - 2.0 * a + b).norm(), (a - 2.0 * b + p).norm());
  curve(
      [&](double t) -> Vec2 {
        const double s = 1.0 - t;
        return s * s * s * from + 3.0 * s * s * t * a + 3.0 * s * t * t * b + t * t * t * p;
      },
      bend_mm);
}

void Outline::arc(const Vec2& middle, const Vec2& u, const Vec2& v, double from_rad, double sweep_rad, bool begins) {
  const auto at = [&](double t) -> Vec2 {
    return middle + std::cos(from_rad + t * sweep_rad) * u + std::sin(from_rad + t * sweep_rad) * v;
  };
  if (begins) move_to(at(0.0));
  // |u cos + v sin| is at most the root of |u|² + |v|².
  curve(at, sweep_rad * sweep_rad * std::hypot(u.norm(), v.norm()));
}

// Lines of a drawing lie in any order and direction, so the open curve whose end is nearest is appended again and
// again.
std::vector<std::vector<Vec2>> Outline::joined() {
  std::vector<std::vector<Vec2>> rings, open;
  for (Path& path : paths_) {
    // A point alone, or a line of no length, as a stray click leaves it.
    if (std::ranges::all_of(path.points, [&](const Vec2& p) { return p == path.points.front(); })) continue;
    const bool is_ring =
        path.is_closed || (path.points.size() > 2 && (path.points.front() - path.points.back()).norm() <= kJoined_mm);
    (is_ring ? rings : open).push_back(std::move(path.points));
  }
  while (!open.empty()) {
    std::vector<Vec2> chain = std::move(open.back());
    open.pop_back();
    while (chain.size() < 3 || (chain.front() - chain.back()).norm() > kJoined_mm) {
      std::size_t best = 0;
      double gap_mm = std::numeric_limits<double>::infinity();
      bool is_reversed = false;
      for (std::size_t k = 0; k < open.size(); ++k) {
        const double ahead_mm = (open[k].front() - chain.back()).norm();
        const double back_mm = (open[k].back() - chain.back()).norm();
        if (std::min(ahead_mm, back_mm) >= gap_mm) continue;
        best = k;
        gap_mm = std::min(ahead_mm, back_mm);
        is_reversed = back_mm < ahead_mm;
      }
      if (gap_mm > kJoined_mm) {
        const double to_start_mm = (chain.front() - chain.back()).norm();
        throw InputError(fmt::format(
            "{}: the outline is open at ({:.3f}, {:.3f}) mm: the nearest end is {:.3g} mm away (at most {:g} mm are "
            "joined); close it in the drawing",
            name_, chain.back().x(), chain.back().y(), std::min(gap_mm, to_start_mm), kJoined_mm));
      }
      if (is_reversed) std::ranges::reverse(open[best]);
      chain.insert(chain.end(), open[best].begin() + 1, open[best].end());
      open.erase(open.begin() + static_cast<std::ptrdiff_t>(best));
    }
    rings.push_back(std::move(chain));
  }
  for (std::vector<Vec2>& ring : rings) {
    if ((ring.front() - ring.back()).norm() <= kJoined_mm) ring.pop_back();
  }
  return rings;
}

Polygon Outline::polygon() {
  std::vector<std::vector<Vec2>> rings = joined();
  if (rings.empty())
    throw InputError(name_ + ": holds no line, arc or curve that is shown; draw the outline as a closed curve");
  std::ranges::sort(rings, {}, [](const auto& ring) { return -std::abs(ring_area(ring)); });
  const auto outer = std::ranges::count_if(rings, [&](const auto& ring) {
    return std::ranges::none_of(rings, [&](const auto& other) { return &other != &ring && is_inside(other, ring[0]); });
  });
  if (outer > 1)
    throw InputError(fmt::format(
        "{}: holds {} outlines beside each other; place each one alone, from a file of its own", name_, outer));
  Polygon polygon;
  polygon.outer = std::move(rings.front());
  polygon.holes.assign(std::make_move_iterator(rings.begin() + 1), std::make_move_iterator(rings.end()));
  return polygon;
}

}  // namespace triskin::placement
