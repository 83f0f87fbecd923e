// SPDX-License-Identifier: GPL-3.0-or-later
#include "exact_recheck.hpp"

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <fmt/format.h>

#include <cmath>
#include <stdexcept>

namespace triskin::geometry {
namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Point = Kernel::Point_2;

// An edge meets the open triangle unless a side or the edge's line separates them (both convex).
bool separated(const std::array<Point, 3>& t, const Point& a, const Point& b) {
  for (std::size_t k = 0; k < 3; ++k) {
    const Point &p = t[k], &q = t[(k + 1) % 3];
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

void require_exact(const PreparedPolygon& polygon, const Motion& motion, const std::vector<Tile>& tiles, double tolerance_mm,
                   double pitch_mm) {
  const double c = std::cos(motion.theta), s = std::sin(motion.theta);
  std::vector<std::array<Point, 2>> edges;
  for (const auto& e : polygon.edges) {
    const auto move = [&](const Vec2& p) { return Point(c * p.x() - s * p.y() + motion.x, s * p.x() + c * p.y() + motion.y); };
    edges.push_back({move(e[0]), move(e[1])});
  }
  // Shrinking by a little more than the tolerance leaves room for the rounding of the motion itself.
  const double shrink = 1.0 - (tolerance_mm + 1e-9) / kInradius_mm;
  for (const Tile& tile : tiles) {
    const TileGeometry g = tile_geometry(tile, pitch_mm);
    std::array<Point, 3> corners;
    for (std::size_t k = 0; k < 3; ++k) {
      const Vec2 p = g.center + shrink * (g.corner[k] - g.center);
      corners[k] = {p.x(), p.y()};
    }
    const Point center(g.center.x(), g.center.y());
    bool inside = false;
    for (const auto& [a, b] : edges) {
      if (!separated(corners, a, b)) {
        throw std::logic_error(fmt::format("placement: tile ({}, {}, {}) is cut by an edge", tile.i, tile.j, tile.up ? "up" : "down"));
      }
      if ((a.y() > center.y()) == (b.y() > center.y())) continue;
      if ((CGAL::orientation(a, b, center) == CGAL::LEFT_TURN) == (b.y() > a.y())) inside = !inside;
    }
    if (!inside) throw std::logic_error(fmt::format("placement: tile ({}, {}) lies outside", tile.i, tile.j));
  }
}

}  // namespace triskin::geometry
