// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernels/exact_recheck.hpp"

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace triskin::placement {
namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Point = Kernel::Point_2;

// An edge meets the open tile unless a side or the edge's line separates them (both convex).
bool separated(const std::vector<Point>& t, const Point& a, const Point& b) {
  for (std::size_t k = 0; k < t.size(); ++k) {
    const Point &p = t[k], &q = t[(k + 1) % t.size()];
    if (CGAL::orientation(p, q, a) != CGAL::LEFT_TURN && CGAL::orientation(p, q, b) != CGAL::LEFT_TURN) return true;
  }
  int left = 0, right = 0;
  for (const Point& c : t) {
    const auto o = CGAL::orientation(a, b, c);
    left += o == CGAL::LEFT_TURN ? 1 : 0;
    right += o == CGAL::RIGHT_TURN ? 1 : 0;
  }
  return a != b && (left == 0 || right == 0);
}

}  // namespace

void require_exact(const PreparedPolygon& polygon, const Motion& motion, const std::vector<Tile>& tiles,
                   double tolerance_mm, const TileGrid& grid) {
  const double c = std::cos(motion.theta), s = std::sin(motion.theta);
  std::vector<std::array<Point, 2>> edges;
  for (const auto& e : polygon.edges) {
    const auto move = [&](const Vec2& p) {
      return Point(c * p.x() - s * p.y() + motion.x, s * p.x() + c * p.y() + motion.y);
    };
    edges.push_back({move(e[0]), move(e[1])});
  }
  // Shrinking by a little more than the tolerance leaves room for the rounding of the motion itself.
  const double shrink = 1.0 - (tolerance_mm + polygon.rounding_mm) / grid.inradius_mm;
  for (const Tile& tile : tiles) {
    const Vec2 middle = grid.center(tile);
    const double scale = tile.up ? shrink : -shrink;
    std::vector<Point> corners;
    for (int k = 0; k < grid.corners; ++k) {
      const Vec2 p = middle + scale * grid.corner[static_cast<std::size_t>(k)];
      corners.emplace_back(p.x(), p.y());
    }
    const Point center(middle.x(), middle.y());
    const double near = grid.circumradius_mm + 1.0;
    bool inside = false;
    for (const auto& [a, b] : edges) {
      const bool far = std::min(a.x(), b.x()) > center.x() + near || std::max(a.x(), b.x()) < center.x() - near ||
                       std::min(a.y(), b.y()) > center.y() + near || std::max(a.y(), b.y()) < center.y() - near;
      if (!far && !separated(corners, a, b)) {
        throw std::logic_error(
            fmt::format("placement: tile ({}, {}, {}) is cut by an edge", tile.i, tile.j, tile.up ? "up" : "down"));
      }
      if ((a.y() > center.y()) == (b.y() > center.y())) continue;
      if ((CGAL::orientation(a, b, center) == CGAL::LEFT_TURN) == (b.y() > a.y())) inside = !inside;
    }
    if (!inside) throw std::logic_error(fmt::format("placement: tile ({}, {}) lies outside", tile.i, tile.j));
  }
}

}  // namespace triskin::placement
