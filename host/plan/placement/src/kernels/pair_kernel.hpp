// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstdint>
#include <vector>

#include "kernels/tile_grid.hpp"
#include "kernels/tile_polygon.hpp"

namespace triskin::placement {

/// A tile and an edge that may cut it. The pairs of one tile are consecutive.
struct Pair {
  std::uint32_t tile = 0;
  std::uint32_t edge = 0;
};

/// In the whole cell, no test has yet decided whether this tile counts.
struct OpenTile {
  Vec2 center;
  Tile tile;
  bool inside = false;                 ///< Its centre lies inside the polygon in the whole cell.
  std::uint32_t first = 0, count = 0;  ///< The pairs of the tile are at [first, first + count).
};

/// A box of motions: its low and high corner in (x mm, y mm, theta rad), low ≤ high on each axis.
struct MotionBox {
  std::array<double, 3> low{}, high{};
  [[nodiscard]] double center(std::size_t k) const { return 0.5 * (low[k] + high[k]); }
  [[nodiscard]] double half(std::size_t k) const { return 0.5 * (high[k] - low[k]); }
};

/// Holds the polygon at the centre of a cell and the bounds of its motion inside the cell.
struct CellFrame {
  std::array<double, 3> center{}, half{};
  double cosine = 1.0, sine = 0.0;
  double reach_mm = 0.0;       ///< No point of the polygon moves farther than this inside the cell.
  double pad_mm = 0.0;         ///< The pad covers the curvature and rounding that the first-order values omit.
  double inset_mm = 0.0;       ///< A tile cannot count below this separation.
  double sufficient_mm = 0.0;  ///< A tile with this separation or more counts.
  double certain_mm = 0.0;     ///< A tile that keeps this separation in the whole cell is decided and leaves the list.
  std::vector<double> x, y;    ///< Each edge begins here after the turn, without the shift.
  std::vector<double> normal_x, normal_y;  ///< The left normal of each edge is given after the turn.

  void set(const PreparedPolygon& polygon, const TileGrid& grid, const MotionBox& box, double inset, double sufficient);
};

inline constexpr std::size_t kLanes = 8, kMaxCorners = 6;
/// Holds the result for a block of pairs. The edge does not cut the tile if the edge lies beyond a side of the tile, or
/// the tile lies on one side of the edge's line; each of these ways to separate them is a direction.
struct PairBlock {
  /// Outside these offsets from the cell's centre every direction fails; low > high means that the edge always cuts the
  /// tile.
  alignas(64) std::array<std::array<double, kLanes>, 3> low, high;
  /// If this is at least sufficient + pad, one direction holds in the whole cell.
  alignas(64) std::array<double, kLanes> surest;
  alignas(64) std::array<double, kLanes> value;  ///< Each value is the separation at the centre.

  /// The directions are [0] tile left of the line, [1] right of it, [2 + k] beyond side k. A negative room means that
  /// the direction holds nowhere.
  alignas(64) std::array<std::array<double, kLanes>, 2 + kMaxCorners> room;
  /// The constraints at the centre and their slopes by theta: [j] is corner j over the line (direction 0; negated: 1),
  /// followed by two for each side, one for each end of the edge.
  alignas(64) std::array<std::array<double, kLanes>, 3 * kMaxCorners> level, slope;
};

/// Evaluates up to kLanes pairs at once. The widest instruction set of the processor is chosen at the first call; all
/// give the same bits, since all do the same IEEE operations.
void evaluate_pairs(const PreparedPolygon& polygon, const TileGrid& grid, const CellFrame& frame, const OpenTile* tiles,
                    const Pair* pairs, std::size_t count, PairBlock& result);

}  // namespace triskin::placement
