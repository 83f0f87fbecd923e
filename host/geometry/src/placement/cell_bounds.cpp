// SPDX-License-Identifier: GPL-3.0-or-later
#include "cell_bounds.hpp"

#include <algorithm>
#include <cmath>

namespace triskin::geometry {
namespace {

// Rounding of the first-order values, mm: coordinates reach a few metres, sums have a handful of terms.
constexpr double kRounding_mm = 1e-9;

// One separating direction: all of its linear constraints must hold.
class Direction {
 public:
  explicit Direction(const CellFrame& frame) : frame_(frame), half_(frame.box.half) {
    for (std::size_t k = 0; k < 3; ++k) {
      box_.low[k] = -half_[static_cast<Eigen::Index>(k)];
      box_.high[k] = half_[static_cast<Eigen::Index>(k)];
    }
  }

  // value + (gx, gy, gt)·offset ± pad bounds the true separation; `reach` is |gx| half x + |gy| half y.
  // False: the direction is impossible in the whole cell.
  bool require(double value, const Vec2& g, const Vec2& inverse_g, double gt, double inverse_gt, double reach, double pad) {
    const double spread = reach + std::abs(gt) * half_[2];
    lowest_ = std::min(lowest_, value);
    if (value - spread - pad < frame_.sufficient_mm) certain_ = false;
    const double slack = value + pad - frame_.inset_mm;
    if (slack + spread < 0.0) return false;
    if (slack >= spread) return true;  // clips nothing
    clip(0, slack + spread - std::abs(g.x()) * half_[0], inverse_g.x());
    clip(1, slack + spread - std::abs(g.y()) * half_[1], inverse_g.y());
    clip(2, slack + reach, inverse_gt);
    return !box_.empty();
  }

  [[nodiscard]] bool certain() const { return certain_; }
  [[nodiscard]] bool free_at_center() const { return lowest_ >= frame_.sufficient_mm; }
  [[nodiscard]] const OffsetBox& box() const { return box_; }

 private:
  // What the other axes can give at most is in `rest`; the missing part must come from this axis.
  void clip(std::size_t axis, double rest, double inverse) {
    if (inverse == 0.0) return;
    const double limit = -rest * inverse;
    if (inverse > 0.0) box_.low[axis] = std::max(box_.low[axis], limit);
    else box_.high[axis] = std::min(box_.high[axis], limit);
  }

  const CellFrame& frame_;
  const Eigen::Array3d& half_;
  OffsetBox box_;
  bool certain_ = true;
  double lowest_ = 1e300;
};

// Collects the directions of one pair of tile and edge.
struct Hull {
  OffsetBox box{{1e300, 1e300, 1e300}, {-1e300, -1e300, -1e300}};
  bool any = false, free_at_center = false;

  void include(const Direction& d) {
    any = true;
    free_at_center = free_at_center || d.free_at_center();
    for (std::size_t k = 0; k < 3; ++k) {
      box.low[k] = std::min(box.low[k], d.box().low[k]);
      box.high[k] = std::max(box.high[k], d.box().high[k]);
    }
  }
};

// True: the side separates the tile from the edge in the whole cell.
bool try_side(const CellFrame& f, std::size_t k, double sign, const std::array<Vec2, 2>& arm, const MovedEdge& e, Hull& hull) {
  Direction d(f);
  const Vec2 n = sign * f.normal[k], inverse = sign * f.inverse_normal[k];
  for (std::size_t end = 0; end < 2; ++end) {
    const double value = n.dot(arm[end]) - kInradius_mm;
    if (!d.require(value, n, inverse, sign * e.side_turn[k][end], sign * e.inverse_turn[k][end], f.side_reach[k], e.pad_mm[end])) return false;
  }
  if (d.certain()) return true;
  hull.include(d);
  return false;
}

// The edge's own line: the whole tile on its left (sign +1) or right (−1).
bool try_line(const CellFrame& f, double sign, double shape_sign, double distance, double turn, double pad, const MovedEdge& e, Hull& hull) {
  // The nearest corner settles most pairs.
  double nearest = 1e300;
  for (const double corner : e.corner_value) nearest = std::min(nearest, sign * (distance + shape_sign * corner));
  const double most = e.line_reach + (std::abs(turn) + kCircumradius_mm) * f.box.half[2] + pad;
  if (nearest + most < f.inset_mm) return false;
  if (nearest - most >= f.sufficient_mm) return true;
  Direction d(f);
  const Vec2 g = -sign * e.normal, inverse = -sign * e.inverse_normal;
  for (std::size_t c = 0; c < 3; ++c) {
    const double gt = sign * (turn + shape_sign * e.corner_turn[c]);
    const double value = sign * (distance + shape_sign * e.corner_value[c]);
    if (!d.require(value, g, inverse, gt, gt != 0.0 ? 1.0 / gt : 0.0, e.line_reach, pad)) return false;
  }
  if (d.certain()) return true;
  hull.include(d);
  return false;
}

}  // namespace

CellFrame::CellFrame(const MotionBox& b, double radius_mm, double inset, double sufficient)
    : box(b), inset_mm(inset), sufficient_mm(sufficient), cosine(std::cos(b.center[2])), sine(std::sin(b.center[2])),
      slide_mm(std::hypot(b.half[0], b.half[1])), reach_mm(slide_mm + radius_mm * b.half[2]) {
  static const TileGeometry kUp = tile_geometry({0, 0, true}, kSide_mm);
  for (std::size_t k = 0; k < 3; ++k) {
    normal[k] = kUp.normal[k];
    corner[k] = kUp.corner[k] - kUp.center;
    for (Eigen::Index a = 0; a < 2; ++a) inverse_normal[k][a] = std::abs(normal[k][a]) > 1e-9 ? 1.0 / normal[k][a] : 0.0;
    side_reach[k] = std::abs(normal[k].x()) * b.half[0] + std::abs(normal[k].y()) * b.half[1];
  }
}

MovedEdge CellFrame::move(const std::array<Vec2, 2>& edge) const {
  MovedEdge m;
  const double t = box.half[2];
  for (std::size_t e = 0; e < 2; ++e) {
    const Vec2 turned(cosine * edge[e].x() - sine * edge[e].y(), sine * edge[e].x() + cosine * edge[e].y());
    m.end[e] = turned + Vec2(box.center[0], box.center[1]);
    m.pad_mm[e] = 0.5 * edge[e].norm() * t * t + kRounding_mm;
    for (std::size_t k = 0; k < 3; ++k) {
      m.side_turn[k][e] = -normal[k].x() * turned.y() + normal[k].y() * turned.x();
      m.inverse_turn[k][e] = m.side_turn[k][e] != 0.0 ? 1.0 / m.side_turn[k][e] : 0.0;
    }
  }
  m.along = m.end[1] - m.end[0];
  const double square = m.along.squaredNorm();
  m.inverse_square = square > 0.0 ? 1.0 / square : 0.0;
  const double length = std::sqrt(square);
  m.normal = length > 0.0 ? Vec2(-m.along.y() / length, m.along.x() / length) : Vec2(0, 0);
  const auto inverse = [](double v) { return v != 0.0 ? 1.0 / v : 0.0; };
  m.inverse_normal = {inverse(m.normal.x()), inverse(m.normal.y())};
  m.line_reach = std::abs(m.normal.x()) * box.half[0] + std::abs(m.normal.y()) * box.half[1];
  for (std::size_t c = 0; c < 3; ++c) {
    m.corner_value[c] = m.normal.dot(corner[c]);
    m.corner_turn[c] = -m.normal.y() * corner[c].x() + m.normal.x() * corner[c].y();
  }
  return m;
}

EdgeVerdict judge(const CellFrame& f, const Vec2& tile_center, bool up, const MovedEdge& e, OffsetBox& feasible, bool& free_at_center) {
  const double shape_sign = up ? 1.0 : -1.0;
  const std::array<Vec2, 2> arm{Vec2(e.end[0] - tile_center), Vec2(e.end[1] - tile_center)};
  Hull hull;
  if (e.inverse_square > 0.0) {
    const double distance = -e.normal.dot(arm[0]);
    const Vec2 lever(tile_center.x() - f.box.center[0], tile_center.y() - f.box.center[1]);
    const double turn = -e.normal.y() * lever.x() + e.normal.x() * lever.y();
    const double t = f.box.half[2];
    const double pad = 0.5 * (lever.norm() + kCircumradius_mm) * t * t + f.slide_mm * t + kRounding_mm;
    if (try_line(f, 1.0, shape_sign, distance, turn, pad, e, hull)) return EdgeVerdict::kNeverCuts;
    if (try_line(f, -1.0, shape_sign, distance, turn, pad, e, hull)) return EdgeVerdict::kNeverCuts;
  }
  for (std::size_t k = 0; k < 3; ++k) {
    if (try_side(f, k, shape_sign, arm, e, hull)) return EdgeVerdict::kNeverCuts;
  }
  if (!hull.any) return EdgeVerdict::kAlwaysCuts;
  free_at_center = free_at_center && hull.free_at_center;
  for (std::size_t k = 0; k < 3; ++k) {
    feasible.low[k] = std::max(feasible.low[k], hull.box.low[k]);
    feasible.high[k] = std::min(feasible.high[k], hull.box.high[k]);
  }
  return feasible.empty() ? EdgeVerdict::kAlwaysCuts : EdgeVerdict::kMayCut;
}

}  // namespace triskin::geometry
