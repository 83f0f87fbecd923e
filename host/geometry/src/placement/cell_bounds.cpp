// SPDX-License-Identifier: GPL-3.0-or-later
#include "cell_bounds.hpp"

#include <algorithm>
#include <cmath>

namespace triskin::geometry {
namespace {

// Rounding of the first-order values, mm: coordinates reach a few metres, sums have a handful of terms.
constexpr double kRounding_mm = 1e-9;

// value + gradient·offset + pad ≥ 0 is necessary, value + gradient·offset − pad ≥ 0 sufficient for the true constraint.
struct Linear {
  double value;
  Eigen::Array3d gradient;
  double pad;
};

struct Direction {
  bool possible = true;
  bool certain = true;
  OffsetBox box;

  void require(const Linear& c, const Eigen::Array3d& half) {
    if (!possible) return;
    const Eigen::Array3d reach = c.gradient.abs() * half;
    const double spread = reach.sum();
    if (c.value - spread - c.pad < 0.0) certain = false;
    if (c.value + spread + c.pad < 0.0) {
      possible = false;
      return;
    }
    for (int axis = 0; axis < 3; ++axis) {
      const double g = c.gradient[axis];
      if (g == 0.0) continue;
      // What the other axes can give at most; the rest must come from this one.
      const double others = spread - reach[axis];
      const double limit = -(c.value + c.pad + others) / g;
      if (g > 0.0) box.low[axis] = std::max(box.low[axis], limit);
      else box.high[axis] = std::min(box.high[axis], limit);
    }
    if (box.empty()) possible = false;
  }
};

Direction side_direction(const TileGeometry& tile, std::size_t k, const MovedEdge& edge, const MotionBox& cell, double inset_mm) {
  Direction d{true, true, {-cell.half, cell.half}};
  const Vec2& n = tile.normal[k];
  const double theta = cell.half[2];
  for (std::size_t e = 0; e < 2; ++e) {
    d.require({n.dot(edge.end[e]) - tile.offset[k] - inset_mm, {n.x(), n.y(), n.dot(edge.swing[e])},
               0.5 * edge.lever_mm[e] * theta * theta + kRounding_mm}, cell.half);
  }
  return d;
}

// The edge's own line: the whole tile on its left (sign +1) or right (−1).
Direction line_direction(const TileGeometry& tile, double sign, const MovedEdge& edge, const MotionBox& cell, double inset_mm) {
  Direction d{true, true, {-cell.half, cell.half}};
  if (edge.length_mm <= 0.0) {
    d.possible = d.certain = false;
    return d;
  }
  const Vec2 n = sign * edge.normal;
  const Vec2 turned(-n.y(), n.x());
  const double theta = cell.half[2];
  const double slide = std::hypot(cell.half[0], cell.half[1]);
  for (const Vec2& corner : tile.corner) {
    const Vec2 arm(corner.x() - cell.center[0], corner.y() - cell.center[1]);
    d.require({n.dot(arm) - sign * edge.origin_offset - inset_mm, {-n.x(), -n.y(), turned.dot(arm)},
               0.5 * arm.norm() * theta * theta + slide * theta + kRounding_mm}, cell.half);
  }
  return d;
}

}  // namespace

MovedEdge move_edge(const std::array<Vec2, 2>& edge, const MotionBox& cell) {
  const double c = std::cos(cell.center[2]), s = std::sin(cell.center[2]);
  MovedEdge m;
  for (std::size_t e = 0; e < 2; ++e) {
    const Vec2 turned(c * edge[e].x() - s * edge[e].y(), s * edge[e].x() + c * edge[e].y());
    m.end[e] = turned + Vec2(cell.center[0], cell.center[1]);
    m.swing[e] = {-turned.y(), turned.x()};
    m.lever_mm[e] = edge[e].norm();
  }
  const Vec2 along = m.end[1] - m.end[0];
  m.length_mm = along.norm();
  m.normal = m.length_mm > 0.0 ? Vec2(-along.y() / m.length_mm, along.x() / m.length_mm) : Vec2(0, 0);
  m.origin_offset = m.normal.dot(Vec2(m.end[0] - Vec2(cell.center[0], cell.center[1])));
  return m;
}

EdgeVerdict judge(const TileGeometry& tile, const MovedEdge& edge, const MotionBox& cell, double inset_mm, OffsetBox& feasible) {
  OffsetBox hull{Eigen::Array3d::Constant(1e300), Eigen::Array3d::Constant(-1e300)};
  bool any = false;
  const auto take = [&](const Direction& d) {
    if (!d.possible) return false;
    if (d.certain) return true;
    hull.include(d.box);
    any = true;
    return false;
  };
  for (std::size_t k = 0; k < 3; ++k) {
    if (take(side_direction(tile, k, edge, cell, inset_mm))) return EdgeVerdict::kNeverCuts;
  }
  for (const double sign : {1.0, -1.0}) {
    if (take(line_direction(tile, sign, edge, cell, inset_mm))) return EdgeVerdict::kNeverCuts;
  }
  if (!any) return EdgeVerdict::kAlwaysCuts;
  feasible.clip(hull);
  return feasible.empty() ? EdgeVerdict::kAlwaysCuts : EdgeVerdict::kMayCut;
}

}  // namespace triskin::geometry
