// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <array>
#include <cmath>
#include <vector>

#include "buckets.hpp"
#include "triskin/design/design_types.hpp"

namespace triskin::lattice {

/// Finds the points of a set that lie near a place: a grid of cubes over a box, each with its points. Points outside
/// the box are found as well, more slowly. Cost of a search: the cubes that the ball meets and the points in them,
/// whatever the number of points elsewhere. Value type.
class PointGrid {
 public:
  PointGrid() = default;
  /// Covers the box around `around` with cubes of `cell_mm`, or larger ones so that there are at most kMaxCells.
  PointGrid(const std::vector<Vec3>& around, double cell_mm) {
    Vec3 high = around.empty() ? Vec3::Zero().eval() : around.front();
    low_ = high;
    for (const Vec3& p : around) {
      low_ = low_.cwiseMin(p);
      high = high.cwiseMax(p);
    }
    for (;; cell_mm *= 1.25) {
      double cells = 1.0;
      for (int k = 0; k < 3; ++k) cells *= 1.0 + std::floor((high[k] - low_[k]) / cell_mm);
      if (cells <= kMaxCells) break;
    }
    for (int k = 0; k < 3; ++k) cells_[at(k)] = 1 + static_cast<int>((high[k] - low_[k]) / cell_mm);
    per_mm_ = 1.0 / cell_mm;
    buckets_ = Buckets(cells_[0] * cells_[1] * cells_[2]);
  }

  void add(int point, const Vec3& place) { buckets_.add(point, cell_at(place)); }
  void remove(int point) { buckets_.remove(point); }
  [[nodiscard]] bool holds(int point) const { return buckets_.bucket_of(point) >= 0; }
  void move(int point, const Vec3& place) {
    const int cell = cell_at(place);
    if (cell == buckets_.bucket_of(point)) return;
    buckets_.remove(point);
    buckets_.add(point, cell);
  }

  /// Calls `visit(point)` for every point in the cubes that a ball meets, in no order, and stops with true when a call
  /// answers true. The caller must test whether the point lies in the ball.
  [[nodiscard]] bool any_near(const Vec3& place, double radius_mm, const auto& visit) const {
    const std::array<int, 3> from = cube_at(place - Vec3::Constant(radius_mm)),
                             to = cube_at(place + Vec3::Constant(radius_mm));
    for (int z = from[2]; z <= to[2]; ++z) {
      for (int y = from[1]; y <= to[1]; ++y) {
        const int row = (z * cells_[1] + y) * cells_[0];
        for (int cell = row + from[0]; cell <= row + to[0]; ++cell) {
          for (int point = buckets_.first(cell); point >= 0; point = buckets_.next(point)) {
            if (visit(point)) return true;
          }
        }
      }
    }
    return false;
  }

 private:
  static constexpr double kMaxCells = 400'000.0;  // This many cells take 1.6 MB.

  // Points outside the box belong to the cubes at its border, and so do queries there.
  [[nodiscard]] std::array<int, 3> cube_at(const Vec3& place) const {
    std::array<int, 3> cube{};
    for (int k = 0; k < 3; ++k) {
      const double x = std::floor((place[k] - low_[k]) * per_mm_);
      cube[at(k)] = x > 0.0 ? x < cells_[at(k)] ? static_cast<int>(x) : cells_[at(k)] - 1 : 0;
    }
    return cube;
  }
  [[nodiscard]] int cell_at(const Vec3& place) const {
    const std::array<int, 3> cube = cube_at(place);
    return (cube[2] * cells_[1] + cube[1]) * cells_[0] + cube[0];
  }

  Vec3 low_ = Vec3::Zero();
  double per_mm_ = 1.0;
  std::array<int, 3> cells_{1, 1, 1};
  Buckets buckets_{1};
};

}  // namespace triskin::lattice
