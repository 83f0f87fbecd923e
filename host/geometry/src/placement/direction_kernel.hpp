// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstdint>
#include <vector>

#include "tile_grid.hpp"
#include "tile_polygon.hpp"

namespace triskin::geometry {

/// One way in which one edge may leave one tile alone: 0 … 5 the edge lies beyond that side of the tile; 8, 9 the tile
/// lies left or right of the edge's line. Records of one tile and edge stand together.
struct Direction {
  std::uint32_t tile = 0;
  std::uint32_t code = 0;  ///< edge · 16 + way
  [[nodiscard]] std::uint32_t edge() const { return code >> 4; }
  [[nodiscard]] std::uint32_t way() const { return code & 15u; }
};
inline constexpr std::uint32_t kLeft = 8, kRight = 9;

/// A tile that is not decided in a cell.
struct OpenTile {
  Vec2 center;
  Tile tile;
  bool inside = false;                 ///< its centre lies inside the polygon in the whole cell
  std::uint32_t first = 0, count = 0;  ///< its directions
};

/// Box of motions by its centre and half widths (x mm, y mm, theta rad).
struct MotionBox {
  std::array<double, 3> low{}, high{};
  [[nodiscard]] double center(std::size_t k) const { return 0.5 * (low[k] + high[k]); }
  [[nodiscard]] double half(std::size_t k) const { return 0.5 * (high[k] - low[k]); }
};

/// The polygon at the centre of a cell and what bounds its motion inside the cell.
struct CellFrame {
  std::array<double, 3> center{}, half{};
  double cosine = 1.0, sine = 0.0;
  double reach_mm = 0.0;       ///< how far any point of the polygon moves inside the cell
  double pad_mm = 0.0;         ///< curvature and rounding of the first-order values
  double inset_mm = 0.0;       ///< below this separation a tile cannot count
  double sufficient_mm = 0.0;  ///< from this separation on it counts
  std::vector<double> x, y;                ///< moved first end of each edge, without the shift
  std::vector<double> normal_x, normal_y;  ///< turned left normal of each edge

  void set(const PreparedPolygon& polygon, const TileGrid& grid, const MotionBox& box, double inset, double sufficient);
};

inline constexpr std::size_t kLanes = 8;
/// What the kernel finds for a block of directions.
struct DirectionBlock {
  /// Offsets from the cell's centre at which the direction may hold, each axis with the other two at their best.
  alignas(64) std::array<std::array<double, kLanes>, 3> low, high;
  alignas(64) std::array<double, kLanes> room;    ///< negative: the direction holds nowhere in the cell
  alignas(64) std::array<double, kLanes> surest;  ///< at least sufficient + pad: it holds in the whole cell
  alignas(64) std::array<double, kLanes> value;   ///< separation at the centre
};

/// Judges kLanes directions at once. The fastest instruction set of the processor is chosen at the first call; all give
/// the same bits, since all do the same IEEE operations.
void judge_directions(const PreparedPolygon& polygon, const TileGrid& grid, const CellFrame& frame, const OpenTile* tiles,
                      const Direction* directions, std::size_t count, DirectionBlock& result);

}  // namespace triskin::geometry
