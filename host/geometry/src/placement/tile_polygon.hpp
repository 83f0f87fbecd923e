// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <array>
#include <cmath>
#include <vector>

#include "triskin/geometry/placement.hpp"

namespace triskin::geometry {

/// The polygon as the placement sees it: recentred, as edges with the interior on the left.
struct PreparedPolygon {
  Vec2 first = Vec2::Zero();   ///< subtracted first: inputs may lie 1e6 mm away
  Vec2 center = Vec2::Zero();  ///< subtracted next: a short lever arm keeps rotation bounds tight
  std::vector<std::array<Vec2, 2>> edges;
  double radius_mm = 0.0;      ///< of a circle around the centre that holds the polygon
  /// Edges per horizontal slab, so that a point-in-polygon test reads only those that its ray may meet.
  double slab_low = 0.0, slab_height = 1.0;
  std::vector<std::vector<int>> slabs;

  [[nodiscard]] bool contains(const Vec2& p) const;
};
[[nodiscard]] PreparedPolygon prepare(const Polygon& polygon);

/// Motion of the recentred polygon: q = R(theta)·p + (x, y).
struct Motion {
  double x = 0.0, y = 0.0, theta = 0.0;
};
[[nodiscard]] Placement to_placement(const PreparedPolygon& polygon, const Motion& motion);

/// A convex tile: half planes normal·q ≤ offset and corners, counter-clockwise.
struct TileGeometry {
  std::array<Vec2, 3> normal;
  std::array<double, 3> offset;
  std::array<Vec2, 3> corner;
  Vec2 center;
};
/// Module (side 30 mm) in the cell of a grid with pitch side + gap.
[[nodiscard]] TileGeometry tile_geometry(const Tile& tile, double pitch_mm);

inline constexpr double kInradius_mm = kSide_mm * 0.28867513459481288;
inline constexpr double kCircumradius_mm = 2.0 * kInradius_mm;

/// Largest separation of a tile and a segment over the tile's three sides and the segment's own line, mm; negative:
/// they overlap by that much along the least direction.
[[nodiscard]] double separation(const TileGeometry& tile, const Vec2& a, const Vec2& b);

/// Tiles that lie inside the moved polygon with a margin of `inset_mm` (negative: may stand over by that much), sorted.
/// The paper's Algorithm 1 with holes. Cost: O(edges · tiles they pass + rows · edges).
[[nodiscard]] std::vector<Tile> tiles_inside(const PreparedPolygon& polygon, const Motion& motion, double inset_mm,
                                             double pitch_mm);

/// How many tiles_inside() would return.
[[nodiscard]] int count_inside(const PreparedPolygon& polygon, const Motion& motion, double inset_mm, double pitch_mm);

}  // namespace triskin::geometry
