// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstdint>
#include <vector>

#include "tile_grid.hpp"
#include "tile_polygon.hpp"

namespace triskin::geometry {

/// The paper's Algorithm 1 with holes, for many motions of one polygon: which tiles lie inside with a margin of
/// `inset_mm` (negative: may stand over by that much). Keeps its memory from call to call: one object a thread.
/// Cost of a call: O(edges · tiles they pass + tiles of the polygon's box).
class Evaluator {
 public:
  Evaluator(const PreparedPolygon& polygon, const TileGrid& grid) : polygon_(polygon), grid_(grid) {}

  [[nodiscard]] int count(const Motion& motion, double inset_mm);
  /// Sorted.
  [[nodiscard]] std::vector<Tile> tiles(const Motion& motion, double inset_mm);

 private:
  static constexpr std::uint8_t kFlip = 1, kCut = 2;  // inside and outside change before this tile; an edge cuts it

  void mark(const Motion& motion, double inset_mm);
  void set_frame(double inset_mm);
  void mark_edge(const Vec2& a, const Vec2& b, double inset_mm);
  void mark_row(const Vec2& a, const Vec2& b, double inset_mm, int j, int up);
  [[nodiscard]] bool cuts(const Vec2& center, double sign, const Vec2& a, const Vec2& b, double inset_mm) const;
  [[nodiscard]] std::uint8_t* row(int j, int up) { return marks_.data() + ((j - first_row_) * grid_.kinds + up - (2 - grid_.kinds)) * columns_; }
  [[nodiscard]] int first_column(int j) const {
    return static_cast<int>(std::floor((low_x_ - grid_.row_shift_mm * j) / grid_.row_step_mm)) - 3;
  }

  const PreparedPolygon& polygon_;
  const TileGrid& grid_;
  std::vector<Vec2> moved_;
  std::vector<std::uint8_t> marks_;
  double low_x_ = 0.0;
  int first_row_ = 0, rows_ = 0, columns_ = 0;
};

}  // namespace triskin::geometry
