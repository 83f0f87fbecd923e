// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernels/pair_kernel.hpp"

#include <algorithm>

#include "kernels/vector_unit.hpp"

namespace triskin::placement {
namespace {

using Vector = double __attribute__((vector_size(8 * kLanes), may_alias));

// Inputs of kLanes pairs: tile centre from the pivot, +1 up or −1 down; turned ends and turned normal of the edge,
// its offset.
struct Lanes {
  alignas(64) double x[kLanes], y[kLanes], sign[kLanes], end_x[2][kLanes], end_y[2][kLanes], normal_x[kLanes],
      normal_y[kLanes], offset[kLanes];
};

// Vectors are passed by reference, because passing them by value depends on the instruction set.
[[gnu::always_inline]] inline Vector& vector_at(double* lanes) {
  return *reinterpret_cast<Vector*>(lanes);
}

[[gnu::always_inline]] inline void load(const PreparedPolygon& polygon, const CellFrame& f, const OpenTile* tiles,
                                        const Pair* pairs, std::size_t count, Lanes& to) {
  for (std::size_t l = 0; l < kLanes; ++l) {
    const Pair pair = pairs[l < count ? l : 0];
    const OpenTile& tile = tiles[pair.tile];
    const std::size_t edge = pair.edge, next = polygon.next[edge];
    to.x[l] = tile.center.x() - f.center[0];
    to.y[l] = tile.center.y() - f.center[1];
    to.sign[l] = tile.tile.up ? 1.0 : -1.0;
    to.end_x[0][l] = f.x[edge];
    to.end_y[0][l] = f.y[edge];
    to.end_x[1][l] = f.x[next];
    to.end_y[1][l] = f.y[next];
    to.normal_x[l] = f.normal_x[edge];
    to.normal_y[l] = f.normal_y[edge];
    to.offset[l] = polygon.line_offset[edge];
  }
}

// Collects the hull over the directions of a pair and the best separations among them.
struct Hull {
  Vector low_x, low_y, low_t, high_x, high_y, high_t, surest, value;
};

// These terms of the cell are equal for all directions: half widths, and pad less inset.
struct CellTerms {
  double hx, hy, ht, pad_less_inset;
};

// One direction has N linear constraints value ≥ inset with one common gradient (gx, gy) in x and y, and a slope each
// by theta. Refers to the caller's vectors.
template <int N>
struct Direction {
  const Vector (&value)[N];
  const Vector (&slope)[N];
  const Vector (&inverse_slope)[N];  // The values are 1 / |slope|.
  const Vector &gx, &gy;
  const Vector &inverse_x, &inverse_y;  // The values are 1 / |gx| and 1 / |gy|.
  const Vector& reach;                  // Inside the cell x and y change the value by at most this.
};

// Adds a direction to the hull and writes its room. While one axis is clipped, the others take their best value.
template <int N>
[[gnu::always_inline]] inline void include(Hull& hull, const CellTerms& cell, const Direction<N>& d, Vector& room_of) {
  const Vector zero = {}, full_x = zero + cell.hx, full_y = zero + cell.hy;
  Vector room = zero + 1e300, sure = room, least = room, low_t = zero - cell.ht, high_t = zero + cell.ht;
  for (int j = 0; j < N; ++j) {
    const Vector steep = d.slope[j] < zero ? -d.slope[j] : d.slope[j];
    const Vector turn = steep * cell.ht, open = d.value[j] + cell.pad_less_inset + d.reach;
    const Vector this_room = open + turn, this_sure = d.value[j] - d.reach - turn;
    room = this_room < room ? this_room : room;
    sure = this_sure < sure ? this_sure : sure;
    least = d.value[j] < least ? d.value[j] : least;
    const Vector limit = open * d.inverse_slope[j];
    const Vector low = d.slope[j] > zero ? -limit : low_t, high = d.slope[j] > zero ? high_t : limit;
    low_t = low > low_t ? low : low_t;
    high_t = high < high_t ? high : high_t;
  }
  const Vector open_x = room * d.inverse_x - cell.hx, open_y = room * d.inverse_y - cell.hy;
  const Vector limit_x = open_x < full_x ? open_x : full_x, limit_y = open_y < full_y ? open_y : full_y;
  const Vector left_t = high_t - low_t;
  room = left_t < room ? left_t : room;  // A negative room means that the direction holds nowhere.
  room_of = room;
  const Vector never_low = zero + 1e300, never_high = zero - 1e300;
  const Vector low_x = room >= zero ? (d.gx > zero ? -limit_x : -full_x) : never_low,
               high_x = room >= zero ? (d.gx > zero ? full_x : limit_x) : never_high;
  const Vector low_y = room >= zero ? (d.gy > zero ? -limit_y : -full_y) : never_low,
               high_y = room >= zero ? (d.gy > zero ? full_y : limit_y) : never_high;
  low_t = room >= zero ? low_t : never_low;
  high_t = room >= zero ? high_t : never_high;
  hull.low_x = low_x < hull.low_x ? low_x : hull.low_x;
  hull.low_y = low_y < hull.low_y ? low_y : hull.low_y;
  hull.low_t = low_t < hull.low_t ? low_t : hull.low_t;
  hull.high_x = high_x > hull.high_x ? high_x : hull.high_x;
  hull.high_y = high_y > hull.high_y ? high_y : hull.high_y;
  hull.high_t = high_t > hull.high_t ? high_t : hull.high_t;
  hull.surest = sure > hull.surest ? sure : hull.surest;
  hull.value = least > hull.value ? least : hull.value;
}

// Takes the absolute value, but never one so small that a product of six reciprocals overflows.
[[gnu::always_inline]] inline void bounded_size(const Vector& v, Vector& size) {
  const Vector zero = {}, tiny = zero + 1e-30;
  size = v < zero ? -v : v;
  size = size > tiny ? size : tiny;
}

// Computes the reciprocals of N sizes with one division.
template <int N>
[[gnu::always_inline]] inline void invert(const Vector (&size)[N], Vector (&inverse)[N]) {
  Vector product[N];
  product[0] = size[0];
  for (int k = 1; k < N; ++k) product[k] = product[k - 1] * size[k];
  const Vector zero = {};
  Vector rest = (zero + 1.0) / product[N - 1];
  for (int k = N - 1; k > 0; --k) {
    inverse[k] = rest * product[k - 1];
    rest = rest * size[k];
  }
  inverse[0] = rest;
}

// Tests the edge's own line: all corners of the tile left of it, or all right of it. The separation of a corner falls
// as the edge moves along its normal.
template <int J>
[[gnu::always_inline]] inline void lines(Hull& hull, const CellTerms& cell, const TileGrid& grid, Lanes& in,
                                         PairBlock& out) {
  const Vector x = vector_at(in.x), y = vector_at(in.y), sign = vector_at(in.sign);
  const Vector nx = vector_at(in.normal_x), ny = vector_at(in.normal_y);
  const Vector base = nx * x + ny * y - vector_at(in.offset), turn = nx * y - ny * x;
  Vector value[J], slope[J], size[J + 2], inverse[J + 2], opposite_value[J], opposite_slope[J], inverse_t[J];
  for (int j = 0; j < J; ++j) {
    const double cx = grid.corner[static_cast<std::size_t>(j)].x(), cy = grid.corner[static_cast<std::size_t>(j)].y();
    value[j] = base + sign * (nx * cx + ny * cy);
    slope[j] = turn + sign * (nx * cy - ny * cx);
    opposite_value[j] = -value[j];
    opposite_slope[j] = -slope[j];
    vector_at(out.level[static_cast<std::size_t>(j)].data()) = value[j];
    vector_at(out.slope[static_cast<std::size_t>(j)].data()) = slope[j];
    bounded_size(slope[j], size[j + 2]);
  }
  bounded_size(nx, size[0]);
  bounded_size(ny, size[1]);
  if constexpr (J <= 4) {
    invert<J + 2>(size, inverse);
  } else {
    const Vector zero = {};
    for (int j = 0; j < J + 2; ++j) inverse[j] = (zero + 1.0) / size[j];
  }
  for (int j = 0; j < J; ++j) inverse_t[j] = inverse[j + 2];
  const Vector reach = size[0] * cell.hx + size[1] * cell.hy;
  const Vector back_x = -nx, back_y = -ny;
  include<J>(hull, cell, {value, slope, inverse_t, back_x, back_y, inverse[0], inverse[1], reach},
             vector_at(out.room[0].data()));
  include<J>(hull, cell, {opposite_value, opposite_slope, inverse_t, nx, ny, inverse[0], inverse[1], reach},
             vector_at(out.room[1].data()));
}

// Tests the sides of the tile: both ends of the edge beyond one of them.
template <int J>
[[gnu::always_inline]] inline void sides(Hull& hull, const CellTerms& cell, const TileGrid& grid, Lanes& in,
                                         PairBlock& out) {
  const Vector x = vector_at(in.x), y = vector_at(in.y), sign = vector_at(in.sign), zero = {};
  for (int k = 0; k < J; ++k) {
    const double nx = grid.normal[static_cast<std::size_t>(k)].x(), ny = grid.normal[static_cast<std::size_t>(k)].y();
    Vector value[2], slope[2], size[2], inverse[2];
    for (int e = 0; e < 2; ++e) {
      const Vector ex = vector_at(in.end_x[e]), ey = vector_at(in.end_y[e]);
      value[e] = sign * (nx * (ex - x) + ny * (ey - y)) - grid.offset_mm[static_cast<std::size_t>(k)];
      slope[e] = sign * (ny * ex - nx * ey);
      bounded_size(slope[e], size[e]);
      vector_at(out.level[static_cast<std::size_t>(J + 2 * k + e)].data()) = value[e];
      vector_at(out.slope[static_cast<std::size_t>(J + 2 * k + e)].data()) = slope[e];
    }
    invert<2>(size, inverse);
    const double ax = std::max(std::abs(nx), 1e-30), ay = std::max(std::abs(ny), 1e-30);
    const Vector gx = sign * nx, gy = sign * ny, inverse_x = zero + 1.0 / ax, inverse_y = zero + 1.0 / ay,
                 reach = zero + (ax * cell.hx + ay * cell.hy);
    include<2>(hull, cell, {value, slope, inverse, gx, gy, inverse_x, inverse_y, reach},
               vector_at(out.room[static_cast<std::size_t>(2 + k)].data()));
  }
}

template <int J>
[[gnu::always_inline]] inline void evaluate(const PreparedPolygon& polygon, const TileGrid& grid, const CellFrame& f,
                                            const OpenTile* tiles, const Pair* pairs, std::size_t count,
                                            PairBlock& result) {
  Lanes in;
  load(polygon, f, tiles, pairs, count, in);
  const CellTerms cell{f.half[0], f.half[1], f.half[2], f.pad_mm - f.inset_mm};
  const Vector zero = {}, most = zero + 1e300, least = zero - 1e300;
  Hull hull{most, most, most, least, least, least, least, least};
  lines<J>(hull, cell, grid, in, result);
  sides<J>(hull, cell, grid, in, result);
  vector_at(result.low[0].data()) = hull.low_x;
  vector_at(result.low[1].data()) = hull.low_y;
  vector_at(result.low[2].data()) = hull.low_t;
  vector_at(result.high[0].data()) = hull.high_x;
  vector_at(result.high[1].data()) = hull.high_y;
  vector_at(result.high[2].data()) = hull.high_t;
  vector_at(result.surest.data()) = hull.surest;
  vector_at(result.value.data()) = hull.value;
}

using Kernel = void (*)(const PreparedPolygon&, const TileGrid&, const CellFrame&, const OpenTile*, const Pair*,
                        std::size_t, PairBlock&);

#define TRISKIN_EVALUATE(unit, target)                                                                            \
  template <int J>                                                                                                \
  target void evaluate_##unit(const PreparedPolygon& p, const TileGrid& g, const CellFrame& f, const OpenTile* t, \
                              const Pair* d, std::size_t n, PairBlock& r) {                                       \
    evaluate<J>(p, g, f, t, d, n, r);                                                                             \
  }
TRISKIN_FOR_VECTOR_UNITS(TRISKIN_EVALUATE)
#undef TRISKIN_EVALUATE

}  // namespace

void CellFrame::set(const PreparedPolygon& polygon, const TileGrid& grid, const MotionBox& box, double inset,
                    double sufficient) {
  for (std::size_t k = 0; k < 3; ++k) {
    center[k] = box.center(k);
    half[k] = box.half(k) * (1.0 + 1e-12) + 1e-15;
  }
  cosine = std::cos(center[2]);
  sine = std::sin(center[2]);
  inset_mm = inset;
  sufficient_mm = sufficient;
  const double slide = std::hypot(half[0], half[1]);
  reach_mm = slide + polygon.radius_mm * half[2];
  // |second derivative by theta| is at most the lever arm, the mixed ones at most 1.
  const double lever = polygon.radius_mm + 2.0 * grid.circumradius_mm + reach_mm + std::abs(inset);
  pad_mm = 0.5 * lever * half[2] * half[2] + slide * half[2] + polygon.rounding_mm;
  const std::size_t n = polygon.edges.size();
  x.resize(n);
  y.resize(n);
  normal_x.resize(n);
  normal_y.resize(n);
  for (std::size_t k = 0; k < n; ++k) {
    x[k] = cosine * polygon.x[k] - sine * polygon.y[k];
    y[k] = sine * polygon.x[k] + cosine * polygon.y[k];
    normal_x[k] = cosine * polygon.normal_x[k] - sine * polygon.normal_y[k];
    normal_y[k] = sine * polygon.normal_x[k] + cosine * polygon.normal_y[k];
  }
}

void evaluate_pairs(const PreparedPolygon& polygon, const TileGrid& grid, const CellFrame& frame, const OpenTile* tiles,
                    const Pair* pairs, std::size_t count, PairBlock& result) {
  static const Kernel kThree = fastest<Kernel>(evaluate_plain<3>, evaluate_avx2<3>, evaluate_avx512<3>);
  static const Kernel kFour = fastest<Kernel>(evaluate_plain<4>, evaluate_avx2<4>, evaluate_avx512<4>);
  static const Kernel kSix = fastest<Kernel>(evaluate_plain<6>, evaluate_avx2<6>, evaluate_avx512<6>);
  (grid.corners == 3 ? kThree : grid.corners == 4 ? kFour : kSix)(polygon, grid, frame, tiles, pairs, count, result);
}

}  // namespace triskin::placement
