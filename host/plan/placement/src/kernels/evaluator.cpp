// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernels/evaluator.hpp"

#include <algorithm>

namespace triskin::placement {
// Marks have room for every tile that an edge can cut. An edge that cuts a tile meets the tile grown by the inset: a
// corner moves out more than a side, and at a level side the tile extends no farther than the inset.
void Evaluator::set_frame(double inset_mm) {
  double high_x = -1e300, low_y = 1e300, high_y = -1e300;
  low_x_ = 1e300;
  for (const Vec2& v : moved_) {
    low_x_ = std::min(low_x_, v.x());
    high_x = std::max(high_x, v.x());
    low_y = std::min(low_y, v.y());
    high_y = std::max(high_y, v.y());
  }
  const double grown = 1.0 + std::max(0.0, inset_mm) / grid_.inradius_mm,
               reach = grid_.circumradius_mm * grown + polygon_.rounding_mm;
  low_x_ -= reach;
  first_row_ = static_cast<int>(std::floor((low_y - reach) / grid_.row_height_mm)) - 2;
  rows_ = static_cast<int>(std::floor((high_y + reach) / grid_.row_height_mm)) + 2 - first_row_;
  columns_ = static_cast<int>(std::ceil((high_x + reach - low_x_) / grid_.row_step_mm)) + 8;
  marks_.assign(static_cast<std::size_t>(grid_.kinds * rows_ * columns_), 0);
  for (int up = 2 - grid_.kinds; up < 2; ++up) set_rows(up, grown);
}

void Evaluator::set_rows(int up, double grown) {
  Rows& rows = kinds_[static_cast<std::size_t>(up)];
  const Vec2& origin = grid_.origin[static_cast<std::size_t>(up)];
  rows.sign = up != 0 ? 1.0 : -1.0;
  rows.first_y = origin.y() + grid_.row_height_mm * first_row_;
  rows.below = rows.above = half_width_ = 0.0;
  for (int k = 0; k < grid_.corners; ++k) {
    const Vec2 corner = rows.sign * grown * grid_.corner[static_cast<std::size_t>(k)];
    rows.below = std::max(rows.below, -corner.y() + polygon_.rounding_mm);
    rows.above = std::max(rows.above, corner.y() + polygon_.rounding_mm);
    half_width_ = std::max(half_width_, std::abs(corner.x()) + polygon_.rounding_mm);
  }
  rows.first_x.resize(static_cast<std::size_t>(rows_));
  for (int r = 0; r < rows_; ++r) {
    const int j = first_row_ + r;
    rows.first_x[static_cast<std::size_t>(r)] =
        origin.x() + grid_.row_shift_mm * j + grid_.row_step_mm * first_column(j);
  }
}

void Evaluator::mark(const Motion& motion, double inset_mm) {
  const double c = std::cos(motion.theta), s = std::sin(motion.theta);
  const std::size_t n = polygon_.x.size();
  moved_.resize(n);
  for (std::size_t k = 0; k < n; ++k) {
    moved_[k] = {c * polygon_.x[k] - s * polygon_.y[k] + motion.x, s * polygon_.x[k] + c * polygon_.y[k] + motion.y};
  }
  set_frame(inset_mm);
  pairs_.clear();
  mark_of_.clear();
  for (int up = 2 - grid_.kinds; up < 2; ++up) {
    for (std::size_t k = 0; k < n; ++k) {
      const Vec2 normal(c * polygon_.normal_x[k] - s * polygon_.normal_y[k],
                        s * polygon_.normal_x[k] + c * polygon_.normal_y[k]);
      mark_edge(k, normal, kinds_[static_cast<std::size_t>(up)], up);
    }
  }
  const std::vector<std::uint8_t>& cuts = pairs_.cuts(grid_, inset_mm);
  for (std::size_t k = 0; k < mark_of_.size(); ++k) marks_[mark_of_[k]] |= static_cast<std::uint8_t>(kCut & cuts[k]);
}

// Rows and columns are counted from the window's corner and so are positive: truncation is the floor.
void Evaluator::mark_edge(std::size_t edge, const Vec2& normal, const Rows& rows, int up) {
  const Vec2 a = moved_[edge], b = moved_[polygon_.next[edge]];
  const double low = std::min(a.y(), b.y()), high = std::max(a.y(), b.y()),
               slope = low < high ? (b.x() - a.x()) / (b.y() - a.y()) : 0.0;
  const double per_row = 1.0 / grid_.row_height_mm, per_column = 1.0 / grid_.row_step_mm;
  const int last_row = static_cast<int>((high + rows.below - rows.first_y) * per_row);
  for (int r = static_cast<int>((low - rows.above - rows.first_y) * per_row) + 1; r <= last_row; ++r) {
    const double y = rows.first_y + grid_.row_height_mm * r, first_x = rows.first_x[static_cast<std::size_t>(r)];
    const std::size_t first = row(first_row_ + r, up);
    if ((a.y() > y) != (b.y() > y)) {
      const double column = (a.x() + (y - a.y()) * slope - first_x) * per_column;
      const int before = static_cast<int>(column);
      marks_[first + static_cast<std::size_t>(before + (before < column ? 1 : 0))] ^= kFlip;
    }
    // Only the part of the edge beside the tiles matters.
    double left = a.x() + (std::max(y - rows.below, low) - a.y()) * slope,
           right = a.x() + (std::min(y + rows.above, high) - a.y()) * slope;
    if (low == high) right = b.x();
    if (left > right) std::swap(left, right);
    const int last = static_cast<int>((right + half_width_ - first_x) * per_column);
    for (int i = static_cast<int>((left - half_width_ - first_x) * per_column) + 1; i <= last; ++i) {
      const double x = first_x + grid_.row_step_mm * i;
      pairs_.add(a.x() - x, a.y() - y, b.x() - x, b.y() - y, normal.x(), normal.y(), rows.sign);
      mark_of_.push_back(static_cast<std::uint32_t>(first) + static_cast<std::uint32_t>(i));
    }
  }
}

int Evaluator::count(const Motion& motion, double inset_mm) {
  mark(motion, inset_mm);
  int n = 0;
  for (std::size_t r = 0; r < marks_.size(); r += static_cast<std::size_t>(columns_)) {
    std::uint8_t inside = 0;
    for (std::size_t k = r; k < r + static_cast<std::size_t>(columns_); ++k) {
      inside = static_cast<std::uint8_t>(inside ^ (marks_[k] & kFlip));
      n += marks_[k] < kCut ? inside : 0;
    }
  }
  return n;
}

std::vector<Tile> Evaluator::tiles(const Motion& motion, double inset_mm) {
  mark(motion, inset_mm);
  std::vector<Tile> found;
  for (int j = first_row_; j < first_row_ + rows_; ++j) {
    for (int up = 2 - grid_.kinds; up < 2; ++up) {
      const std::uint8_t* marks = marks_.data() + row(j, up);
      std::uint8_t inside = 0;
      for (int k = 0; k < columns_; ++k) {
        inside = static_cast<std::uint8_t>(inside ^ (marks[k] & kFlip));
        if (marks[k] < kCut && inside != 0) found.push_back({first_column(j) + k, j, up != 0});
      }
    }
  }
  std::ranges::sort(found);
  return found;
}

}  // namespace triskin::placement
