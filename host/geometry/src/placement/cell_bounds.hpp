// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <Eigen/Core>
#include <array>

#include "tile_polygon.hpp"

namespace triskin::geometry {

/// Box of motions: centre and half widths in (x mm, y mm, theta rad).
struct MotionBox {
  Eigen::Array3d center = Eigen::Array3d::Zero();
  Eigen::Array3d half = Eigen::Array3d::Zero();
};

/// Box in offsets from a cell's centre; empty when any low > high.
struct OffsetBox {
  Eigen::Array3d low, high;
  [[nodiscard]] bool empty() const { return (low > high).any(); }
  void include(const OffsetBox& o) {
    low = low.min(o.low);
    high = high.max(o.high);
  }
  void clip(const OffsetBox& o) {
    low = low.max(o.low);
    high = high.min(o.high);
  }
};

/// An edge at the centre of a cell, with what its bounds need; shared by all tiles of the cell.
struct MovedEdge {
  std::array<Vec2, 2> end;    ///< moved end points
  std::array<Vec2, 2> swing;  ///< their derivative by theta
  std::array<double, 2> lever_mm;
  Vec2 normal;                ///< left unit normal (towards the interior)
  double length_mm = 0.0;
  double origin_offset = 0.0; ///< normal·(end − translation): constant under rotation
};

/// What one edge says about one tile over a cell.
enum class EdgeVerdict { kNeverCuts, kAlwaysCuts, kMayCut };

/// Judges the edge and clips `feasible` to the offsets at which it may leave the tile alone: the hull of the boxes of
/// the five separating directions, each clipped by its first-order constraints (docs/placement.md).
[[nodiscard]] EdgeVerdict judge(const TileGeometry& tile, const MovedEdge& edge, const MotionBox& cell, double inset_mm,
                                OffsetBox& feasible);

[[nodiscard]] MovedEdge move_edge(const std::array<Vec2, 2>& edge, const MotionBox& cell);

}  // namespace triskin::geometry
