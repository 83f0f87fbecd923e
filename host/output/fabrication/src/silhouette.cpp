// SPDX-License-Identifier: GPL-3.0-or-later
#include "silhouette.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "triskin/geometry/segment.hpp"

namespace triskin::fabrication {

using design::Vec2;

double angle_of_turn(int turn) {
  return turn * 2.0 * std::numbers::pi / kTurns;
}

Silhouette::Silhouette(const std::vector<Ring>& rings, int turn, double half_gap_mm, double reach_mm) {
  std::vector<Ring> turned = rings;
  Vec2 low(1e9, 1e9), high(-1e9, -1e9);
  for (Ring& ring : turned) {
    for (Vec2& p : ring) {
      p = rotated(p, angle_of_turn(turn));
      low = low.cwiseMin(p);
      high = high.cwiseMax(p);
    }
  }
  shift_mm_ = Vec2(half_gap_mm, half_gap_mm) - low;
  for (Ring& ring : turned) {
    for (Vec2& p : ring) p += shift_mm_;
  }
  width_ = static_cast<int>(std::ceil((high.x() - low.x() + 2.0 * half_gap_mm) / kPixel_mm));
  height_ = static_cast<int>(std::ceil((high.y() - low.y() + 2.0 * half_gap_mm) / kPixel_mm));
  std::vector<std::vector<char>> is_set(static_cast<std::size_t>(height_),
                                        std::vector<char>(static_cast<std::size_t>(width_), 0));
  fill_inside(turned, is_set);
  for (const Ring& ring : turned) {
    for (std::size_t k = 0; k < ring.size(); ++k) draw_side(ring[k], ring[(k + 1) % ring.size()], reach_mm, is_set);
  }
  store(is_set);
}

// Fills each row between the sides of the rings that cross the middles of its pixels.
void Silhouette::fill_inside(const std::vector<Ring>& rings, std::vector<std::vector<char>>& is_set) const {
  for (int y = 0; y < height_; ++y) {
    const double level = (y + 0.5) * kPixel_mm;
    std::vector<double> crossed;
    for (const Ring& ring : rings) {
      for (std::size_t k = 0; k < ring.size(); ++k) {
        const Vec2 &a = ring[k], &b = ring[(k + 1) % ring.size()];
        if ((a.y() > level) != (b.y() > level))
          crossed.push_back(a.x() + (level - a.y()) / (b.y() - a.y()) * (b.x() - a.x()));
      }
    }
    std::ranges::sort(crossed);
    for (std::size_t k = 0; k + 1 < crossed.size(); k += 2) {
      const int from = std::max(0, static_cast<int>(std::ceil(crossed[k] / kPixel_mm - 0.5)));
      const int to = std::min(width_, static_cast<int>(std::floor(crossed[k + 1] / kPixel_mm + 0.5)));
      for (int x = from; x < to; ++x) is_set[static_cast<std::size_t>(y)][static_cast<std::size_t>(x)] = 1;
    }
  }
}

void Silhouette::draw_side(const Vec2& a, const Vec2& b, double reach_mm,
                           std::vector<std::vector<char>>& is_set) const {
  const Vec2 low = a.cwiseMin(b), high = a.cwiseMax(b);
  const auto pixel = [](double mm, int count) {
    return std::clamp(static_cast<int>(std::floor(mm / kPixel_mm)), 0, count - 1);
  };
  for (int y = pixel(low.y() - reach_mm, height_); y <= pixel(high.y() + reach_mm, height_); ++y) {
    for (int x = pixel(low.x() - reach_mm, width_); x <= pixel(high.x() + reach_mm, width_); ++x) {
      if (geometry::distance_to_segment(Vec2((x + 0.5) * kPixel_mm, (y + 0.5) * kPixel_mm), a, b) <= reach_mm)
        is_set[static_cast<std::size_t>(y)][static_cast<std::size_t>(x)] = 1;
    }
  }
}

void Silhouette::store(const std::vector<std::vector<char>>& is_set) {
  for (const auto& row : is_set) {
    std::vector<Run>& runs = rows_.emplace_back();
    for (int x = 0; x < width_; ++x) {
      if (!row[static_cast<std::size_t>(x)]) continue;
      if (runs.empty() || runs.back().end < x)
        runs.push_back({x, x + 1});
      else
        runs.back().end = x + 1;
    }
    run_count_ += static_cast<int>(runs.size());
  }
}

Silhouette Silhouette::coarser(int ratio) const {
  Silhouette coarse;
  coarse.shift_mm_ = shift_mm_;
  coarse.width_ = (width_ + ratio - 1) / ratio;
  coarse.height_ = (height_ + ratio - 1) / ratio;
  const auto width = static_cast<std::size_t>(coarse.width_), height = static_cast<std::size_t>(coarse.height_);
  std::vector<std::vector<int>> covered(height, std::vector<int>(width, 0));
  for (int y = 0; y < height_; ++y) {
    for (const Run& run : rows_[static_cast<std::size_t>(y)]) {
      for (int x = run.first; x < run.end; ++x)
        ++covered[static_cast<std::size_t>(y / ratio)][static_cast<std::size_t>(x / ratio)];
    }
  }
  std::vector<std::vector<char>> is_set(height, std::vector<char>(width, 0));
  for (std::size_t y = 0; y < height; ++y) {
    for (std::size_t x = 0; x < width; ++x) is_set[y][x] = 2 * covered[y][x] >= ratio * ratio ? 1 : 0;
  }
  coarse.store(is_set);
  return coarse;
}

}  // namespace triskin::fabrication
