// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <vector>

#include "ring.hpp"

namespace triskin::fabrication {

inline constexpr double kPixel_mm = 0.5;
/// Islands consist of triangles: turned by 60° they fit each other, turned by 30° the edges of the sheet.
inline constexpr int kTurns = 12;

/// Returns the angle of a turn, 0 … kTurns − 1, in rad. Constant cost.
[[nodiscard]] double angle_of_turn(int turn);

/// The run covers the pixels first … end − 1 of a row.
struct Run {
  int first, end;
};

/// A silhouette stores, for one turn of an island, the pixels that the island and a margin around it cover, as runs.
class Silhouette {
 public:
  /// `rings` are the outline and the holes that others may lie in. The box of the silhouette is that of the outline and
  /// half the gap; pixels count as covered if their middle is within `reach_mm` of the island. Cost: linear in the
  /// pixels of the box and in the length of the rings.
  Silhouette(const std::vector<Ring>& rings, int turn, double half_gap_mm, double reach_mm);

  /// A point p of the island lies at R(angle_of_turn(turn)) · p + shift when the box begins at (0, 0).
  [[nodiscard]] const design::Vec2& shift_mm() const { return shift_mm_; }
  [[nodiscard]] int width() const { return width_; }
  [[nodiscard]] int height() const { return height_; }
  [[nodiscard]] const std::vector<std::vector<Run>>& rows() const { return rows_; }
  [[nodiscard]] int run_count() const { return run_count_; }

  /// Returns this silhouette in pixels `ratio` times as large; they are covered where at least half of them is. Its
  /// shift is that of the original. Cost: linear in the pixels.
  [[nodiscard]] Silhouette coarser(int ratio) const;

 private:
  Silhouette() = default;
  void fill_inside(const std::vector<Ring>& rings, std::vector<std::vector<char>>& is_set) const;
  void draw_side(const design::Vec2& a, const design::Vec2& b, double reach_mm,
                 std::vector<std::vector<char>>& is_set) const;
  void store(const std::vector<std::vector<char>>& is_set);

  design::Vec2 shift_mm_{0, 0};
  int width_ = 0, height_ = 0, run_count_ = 0;
  std::vector<std::vector<Run>> rows_;
};

/// The indices are the island, then the turn.
using Silhouettes = std::vector<std::vector<Silhouette>>;

/// The box of an island's silhouette begins at pixel (x, y) of its sheet.
struct PixelPlace {
  int sheet = 0, turn = 0, x = 0, y = 0;
};

}  // namespace triskin::fabrication
