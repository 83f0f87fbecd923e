// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernels/tile_polygon.hpp"

#include <algorithm>
#include <limits>

namespace triskin::placement {
namespace {

Vec2 rotate(const Vec2& p, double c, double s) {
  return {c * p.x() - s * p.y(), s * p.x() + c * p.y()};
}

void add_ring(const std::vector<Vec2>& ring, const Vec2& first, std::vector<std::array<Vec2, 2>>& edges) {
  for (std::size_t k = 0; k < ring.size(); ++k) {
    edges.push_back({Vec2(ring[k] - first), Vec2(ring[(k + 1) % ring.size()] - first)});
  }
}

// Finds the centre of a small enclosing circle by steps towards the farthest vertex (Bădoiu and Clarkson, 2003).
Vec2 enclosing_center(const std::vector<std::array<Vec2, 2>>& edges) {
  Vec2 center = edges.front()[0];
  for (int step = 1; step <= 200; ++step) {
    const auto far = std::ranges::max_element(edges, {}, [&](const auto& e) { return (e[0] - center).squaredNorm(); });
    center += ((*far)[0] - center) / (step + 1);
  }
  return center;
}

std::size_t slab_at(const PreparedPolygon& p, double y) {
  const auto last = static_cast<double>(p.slabs.size() - 1);
  return static_cast<std::size_t>(std::clamp((y - p.slab_low) / p.slab_height, 0.0, last));
}

void fill_slabs(PreparedPolygon& p) {
  double low = std::numeric_limits<double>::infinity(), high = -low;
  for (const auto& e : p.edges) {
    low = std::min(low, e[0].y());
    high = std::max(high, e[0].y());
  }
  const std::size_t n = std::clamp<std::size_t>(p.edges.size(), 1, 4096);
  p.slab_low = low;
  p.slab_height = std::max((high - low) / static_cast<double>(n), 1e-12);
  p.slabs.assign(n, {});
  for (std::size_t k = 0; k < p.edges.size(); ++k) {
    const auto [y0, y1] = std::minmax(p.edges[k][0].y(), p.edges[k][1].y());
    for (std::size_t s = slab_at(p, y0); s <= slab_at(p, y1); ++s) p.slabs[s].push_back(static_cast<int>(k));
  }
}

void fill_arrays(PreparedPolygon& p, const Polygon& polygon) {
  for (const auto& [a, b] : p.edges) {
    const Vec2 n = Vec2(a.y() - b.y(), b.x() - a.x()).normalized();
    p.x.push_back(a.x());
    p.y.push_back(a.y());
    p.normal_x.push_back(n.x());
    p.normal_y.push_back(n.y());
    p.line_offset.push_back(n.dot(a));
  }
  const auto add_next = [&](std::size_t count) {
    const auto first = static_cast<std::uint32_t>(p.next.size());
    for (std::uint32_t k = 1; k <= count; ++k) p.next.push_back(k < count ? first + k : first);
  };
  add_next(polygon.outer.size());
  for (const auto& hole : polygon.holes) add_next(hole.size());
}

}  // namespace

bool PreparedPolygon::contains(const Vec2& p) const {
  const double position = (p.y() - slab_low) / slab_height;
  if (position < 0.0 || position > static_cast<double>(slabs.size())) return false;
  const std::size_t slab = std::min(static_cast<std::size_t>(position), slabs.size() - 1);
  bool inside = false;
  for (const int k : slabs[slab]) {
    const auto& [a, b] = edges[static_cast<std::size_t>(k)];
    if ((a.y() > p.y()) == (b.y() > p.y())) continue;
    if (p.x() < a.x() + (p.y() - a.y()) / (b.y() - a.y()) * (b.x() - a.x())) inside = !inside;
  }
  return inside;
}

PreparedPolygon prepare(const Polygon& polygon) {
  PreparedPolygon p;
  p.first = polygon.outer.front();
  add_ring(polygon.outer, p.first, p.edges);
  for (const auto& hole : polygon.holes) add_ring(hole, p.first, p.edges);
  p.center = enclosing_center(p.edges);
  for (auto& e : p.edges) {
    for (Vec2& v : e) v -= p.center;
    p.radius_mm = std::max(p.radius_mm, e[0].norm());
  }
  // Sums of some products of coordinates have six roundings of the radius; five times as much is safe.
  p.rounding_mm = std::max(1e-9, 32.0 * 0x1p-52 * p.radius_mm);
  fill_slabs(p);
  fill_arrays(p, polygon);
  return p;
}

Motion to_motion(const PreparedPolygon& polygon, const Placement& at) {
  const Vec2 moved = rotate(polygon.first + polygon.center, std::cos(at.theta_rad), std::sin(at.theta_rad));
  return {at.x_mm + moved.x(), at.y_mm + moved.y(), at.theta_rad};
}

Placement to_placement(const PreparedPolygon& polygon, const Motion& motion) {
  const Vec2 moved = rotate(polygon.first + polygon.center, std::cos(motion.theta), std::sin(motion.theta));
  return {motion.x - moved.x(), motion.y - moved.y(), motion.theta};
}

}  // namespace triskin::placement
