// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <array>
#include <vector>

#include "triskin/placement/paper/algorithm1.hpp"

namespace triskin::placement::paper {

/// Generating lines of the grid (Section IV-A) have three directions, each with one line per row.
inline constexpr std::size_t kDirections = 3;  // The directions are 0°, 60° and 300°.

/// A polygon on the grid, in affine coordinates (u, v) in which node (i, j) is (i, j): the point a*u*(1, 0) + a*v·(½,
/// √3/2). Lines are v = j (0°), u = i (60°) and u + v = k (300°), so no √3 remains and a point on a line has a
/// whole number. A vertex nearer to a line than the touching distance is moved onto it, for that line only.
class GridFrame {
 public:
  GridFrame(const Polygon& polygon, double touch_mm);

  /// Lays the polygon on the grid. Throws std::out_of_range when the placement's vertex does not exist.
  void move(const PivotedPlacement& placement);

  /// The vertices of ring r are [ring_begin(r), ring_begin(r + 1)).
  [[nodiscard]] std::size_t rings() const { return begin_.size() - 1; }
  [[nodiscard]] std::size_t ring_begin(std::size_t ring) const { return begin_[ring]; }
  /// For each vertex, tells which line of the direction it is at (a whole number means on that line), and where along
  /// it in sides (nodes are at whole numbers).
  [[nodiscard]] const std::vector<double>& across(std::size_t direction) const { return across_[direction]; }
  [[nodiscard]] const std::vector<double>& along(std::size_t direction) const { return along_[direction]; }
  [[nodiscard]] const std::vector<double>& u() const { return u_; }
  [[nodiscard]] const std::vector<double>& v() const { return v_; }
  /// Returns the touching distance along a line, in sides.
  [[nodiscard]] double touch_along() const { return touch_mm_ / kSide_mm; }
  /// Returns the touching distance across lines, in rows.
  [[nodiscard]] double touch_across() const { return touch_mm_ / kHeight_mm; }

 private:
  void turn(double theta);

  std::vector<Vec2> vertices_;  // The first vertex of the outer ring comes first.
  std::vector<std::size_t> begin_;
  Vec2 first_;
  double touch_mm_;
  bool turned_ = false;
  double theta_ = 0.0;
  std::vector<double> turned_u_, turned_v_;
  std::vector<double> u_, v_;
  std::array<std::vector<double>, kDirections> across_, along_;
};

}  // namespace triskin::placement::paper
