// SPDX-License-Identifier: GPL-3.0-or-later
#include "evaluator.hpp"

#include <algorithm>

namespace triskin::geometry {

void Evaluator::set_frame(double inset_mm) {
  double high_x = -1e300, low_y = 1e300, high_y = -1e300;
  low_x_ = 1e300;
  for (const Vec2& v : moved_) {
    low_x_ = std::min(low_x_, v.x());
    high_x = std::max(high_x, v.x());
    low_y = std::min(low_y, v.y());
    high_y = std::max(high_y, v.y());
  }
  // Tiles whose centre lies outside by more than a circumradius are never marked.
  const double reach = std::max(0.0, inset_mm) + grid_.circumradius_mm;
  low_x_ -= reach;
  first_row_ = static_cast<int>(std::floor((low_y - reach) / grid_.row_height_mm)) - 2;
  rows_ = static_cast<int>(std::floor((high_y + reach) / grid_.row_height_mm)) + 2 - first_row_;
  columns_ = static_cast<int>(std::ceil((high_x + reach - low_x_) / grid_.row_step_mm)) + 8;
  marks_.assign(static_cast<std::size_t>(grid_.kinds * rows_ * columns_), 0);
}

void Evaluator::mark(const Motion& motion, double inset_mm) {
  const double c = std::cos(motion.theta), s = std::sin(motion.theta);
  const std::size_t n = polygon_.x.size();
  moved_.resize(n);
  for (std::size_t k = 0; k < n; ++k) {
    moved_[k] = {c * polygon_.x[k] - s * polygon_.y[k] + motion.x, s * polygon_.x[k] + c * polygon_.y[k] + motion.y};
  }
  set_frame(inset_mm);
  for (std::size_t k = 0; k < n; ++k) mark_edge(moved_[k], moved_[polygon_.next[k]], inset_mm);
}

void Evaluator::mark_edge(const Vec2& a, const Vec2& b, double inset_mm) {
  const double reach = std::max(0.0, inset_mm) + grid_.circumradius_mm;
  const auto [low, high] = std::minmax(a.y(), b.y());
  for (int up = 2 - grid_.kinds; up < 2; ++up) {
    const double origin = grid_.origin[static_cast<std::size_t>(up)].y();
    const int last = static_cast<int>(std::floor((high + reach - origin) / grid_.row_height_mm));
    for (int j = static_cast<int>(std::ceil((low - reach - origin) / grid_.row_height_mm)); j <= last; ++j) mark_row(a, b, inset_mm, j, up);
  }
}

void Evaluator::mark_row(const Vec2& a, const Vec2& b, double inset_mm, int j, int up) {
  const double reach = std::max(0.0, inset_mm) + grid_.circumradius_mm;
  const Vec2 origin = grid_.center({0, j, up != 0});
  const int column = first_column(j);
  std::uint8_t* marks = row(j, up);
  const bool above_a = a.y() > origin.y(), above_b = b.y() > origin.y();
  if (above_a != above_b) {
    const double x = a.x() + (origin.y() - a.y()) / (b.y() - a.y()) * (b.x() - a.x());
    marks[static_cast<int>(std::ceil((x - origin.x()) / grid_.row_step_mm)) - column] ^= kFlip;
  }
  double left = std::min(a.x(), b.x()), right = std::max(a.x(), b.x());
  if (a.y() != b.y()) {  // only the part within reach of the row of centres
    const double slope = (b.x() - a.x()) / (b.y() - a.y());
    const double low = std::max(origin.y() - reach, std::min(a.y(), b.y())), high = std::min(origin.y() + reach, std::max(a.y(), b.y()));
    const double x0 = a.x() + (low - a.y()) * slope, x1 = a.x() + (high - a.y()) * slope;
    left = std::max(left, std::min(x0, x1));
    right = std::min(right, std::max(x0, x1));
  }
  const int last = static_cast<int>(std::floor((right + reach - origin.x()) / grid_.row_step_mm));
  for (int i = static_cast<int>(std::ceil((left - reach - origin.x()) / grid_.row_step_mm)); i <= last; ++i) {
    std::uint8_t& m = marks[i - column];
    if ((m & kCut) != 0) continue;
    const Vec2 center(origin.x() + grid_.row_step_mm * i, origin.y());
    if (cuts(center, up != 0 ? 1.0 : -1.0, a, b, inset_mm)) m |= kCut;
  }
}

bool Evaluator::cuts(const Vec2& center, double sign, const Vec2& a, const Vec2& b, double inset_mm) const {
  const Vec2 p = a - center, q = b - center, d = q - p;
  const double square = d.squaredNorm();
  // The circles of the tile settle most pairs: a separation is at most the distance less the inradius.
  const double t = square > 0.0 ? std::clamp(-p.dot(d) / square, 0.0, 1.0) : 0.0;
  const double distance = (p + t * d).squaredNorm();
  const double inner = grid_.inradius_mm + inset_mm - 1e-9, outer = grid_.circumradius_mm + std::max(0.0, inset_mm) + 1e-9;
  if (inner > 0.0 && distance < inner * inner) return true;
  if (distance > outer * outer) return false;
  for (int k = 0; k < grid_.corners; ++k) {
    const Vec2 n = sign * grid_.normal[static_cast<std::size_t>(k)];
    if (std::min(n.dot(p), n.dot(q)) - grid_.inradius_mm >= inset_mm) return false;
  }
  if (!(square > 0.0)) return true;
  const double length = std::sqrt(square);
  const Vec2 n(-d.y() / length, d.x() / length);
  double low = 1e300, high = -1e300;
  for (int k = 0; k < grid_.corners; ++k) {
    const double side = n.dot(sign * grid_.corner[static_cast<std::size_t>(k)] - p);
    low = std::min(low, side);
    high = std::max(high, side);
  }
  return std::max(low, -high) < inset_mm;
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
      const std::uint8_t* marks = row(j, up);
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

}  // namespace triskin::geometry
