// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstdint>
#include <vector>

#include "kernels/cut_kernel.hpp"
#include "kernels/tile_grid.hpp"
#include "kernels/tile_polygon.hpp"

namespace triskin::placement {

/// Finds, for many motions of one polygon with its holes, the tiles that lie inside with a margin of `inset_mm` (a
/// negative one lets them overhang by that much). Keeps its memory between calls, so each thread needs its own object.
/// Cost of a call: O(edges · tiles they pass + tiles of the polygon's box); pairs of edge and tile are evaluated eight
/// at once.
class Evaluator {
 public:
  Evaluator(const PreparedPolygon& polygon, const TileGrid& grid) : polygon_(polygon), grid_(grid) {}

  [[nodiscard]] int count(const Motion& motion, double inset_mm);
  /// Returns the tiles sorted.
  [[nodiscard]] std::vector<Tile> tiles(const Motion& motion, double inset_mm);

 private:
  // kFlip marks a tile before which inside and outside change, kCut a tile that an edge cuts.
  static constexpr std::uint8_t kFlip = 1, kCut = 2;

  struct Rows {
    double sign = 1.0, first_y = 0.0;  // first_y is the height of the centres in row 0.
    double below = 0.0, above = 0.0;   // An edge that cuts a tile may lie this far below and above its centre.
    std::vector<double> first_x;       // The values are the x of the centre in column 0 of each row.
  };
  void mark(const Motion& motion, double inset_mm);
  void set_frame(double inset_mm);
  void set_rows(int up, double grown);
  void mark_edge(std::size_t edge, const Vec2& normal, const Rows& rows, int up);
  /// Returns the index of the first mark of a row.
  [[nodiscard]] std::size_t row(int j, int up) const {
    return static_cast<std::size_t>(((j - first_row_) * grid_.kinds + up - (2 - grid_.kinds)) * columns_);
  }
  [[nodiscard]] int first_column(int j) const {
    return static_cast<int>(std::floor((low_x_ - grid_.row_shift_mm * j) / grid_.row_step_mm)) - 3;
  }

  const PreparedPolygon& polygon_;
  const TileGrid& grid_;
  std::vector<Vec2> moved_;
  std::vector<std::uint8_t> marks_;
  CutPairs pairs_;
  std::vector<std::uint32_t> mark_of_;
  std::array<Rows, 2> kinds_;
  double half_width_ = 0.0;  // An edge that cuts a tile may lie this far beside its centre.
  double low_x_ = 0.0;
  int first_row_ = 0, rows_ = 0, columns_ = 0;
};

}  // namespace triskin::placement
