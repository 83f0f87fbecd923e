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
  std::array<double, 3> low, high;
  [[nodiscard]] bool empty() const { return low[0] > high[0] || low[1] > high[1] || low[2] > high[2]; }
};

/// An edge at the centre of a cell, with what its bounds need; shared by all tiles of the cell. Arrays over the three
/// corners or sides belong to the up tile; the down tile is its mirror through the centre, so the sign changes.
struct MovedEdge {
  std::array<Vec2, 2> end;                            ///< moved end points
  Vec2 along;                                         ///< end[1] − end[0]
  double inverse_square = 0.0;                        ///< 1 / |along|², 0 for a point
  std::array<std::array<double, 2>, 3> side_turn;     ///< d(side normal · end)/dθ per side and end
  std::array<std::array<double, 2>, 3> inverse_turn;  ///< 1 / side_turn, 0 where that is 0
  std::array<double, 2> pad_mm;                       ///< curvature and rounding per end
  Vec2 normal;                                        ///< left unit normal (towards the interior); 0 for a point
  Vec2 inverse_normal;                                ///< 1 / normal per axis, 0 where that is 0
  double line_reach = 0.0;                            ///< |normal.x| half x + |normal.y| half y
  std::array<double, 3> corner_value;                 ///< normal · corner around the tile's centre
  std::array<double, 3> corner_turn;                  ///< turned normal · corner around the tile's centre
};

/// Tile shape around its centre (up tile; the down tile has the opposite sign) and what a cell's box makes of it.
struct CellFrame {
  MotionBox box;
  double inset_mm = 0.0;       ///< necessary separation: below it a tile cannot count
  double sufficient_mm = 0.0;  ///< separation from which on a tile counts (inset − tolerance)
  double cosine = 1.0, sine = 0.0;
  double slide_mm = 0.0;       ///< how far the box translates
  double reach_mm = 0.0;       ///< how far any point of the polygon moves inside the box
  std::array<Vec2, 3> normal, inverse_normal, corner;
  std::array<double, 3> side_reach;  ///< |n.x| half x + |n.y| half y

  CellFrame(const MotionBox& b, double radius_mm, double inset, double sufficient);
  [[nodiscard]] MovedEdge move(const std::array<Vec2, 2>& edge) const;
};

/// What one edge says about one tile over a cell.
enum class EdgeVerdict { kNeverCuts, kAlwaysCuts, kMayCut };

/// Judges the edge and clips `feasible` to the offsets at which it may leave the tile alone: the hull of the boxes of
/// the five separating directions, each clipped by its first-order constraints (docs/placement.md).
/// `free_at_center` turns false when the edge cuts the tile at the cell's centre.
[[nodiscard]] EdgeVerdict judge(const CellFrame& frame, const Vec2& tile_center, bool up, const MovedEdge& edge,
                                OffsetBox& feasible, bool& free_at_center);

}  // namespace triskin::geometry
