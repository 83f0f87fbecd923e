// SPDX-License-Identifier: GPL-3.0-or-later
#include "direction_kernel.hpp"

#include <algorithm>

namespace triskin::geometry {
namespace {

using Vector = double __attribute__((vector_size(8 * kLanes), may_alias));

// Rounding of the first-order values, mm: coordinates reach some metres, sums have a handful of terms.
constexpr double kRounding_mm = 1e-9;

// A direction as linear constraints value_j = A·B_j + C ≥ inset, with gradient (−τA, τ A×B_j) in (x, y, theta):
// side of the tile: A its normal, B_j the turned ends of the edge, τ = −1; line of the edge: A the turned normal of the
// edge, B_j the corners of the tile relative to the polygon's pivot, τ = +1.
template <int J>
struct Lanes {
  alignas(64) double ax[kLanes], ay[kLanes], c[kLanes], turn[kLanes], bx[J][kLanes], by[J][kLanes];
};

// By reference: vectors passed by value would depend on the instruction set.
[[gnu::always_inline]] inline Vector& vector_at(double* lanes) { return *reinterpret_cast<Vector*>(lanes); }

template <int J>
[[gnu::always_inline]] inline void load(const PreparedPolygon& polygon, const TileGrid& grid, const CellFrame& f, const OpenTile* tiles,
                                        const Direction* directions, std::size_t count, Lanes<J>& to) {
  for (std::size_t l = 0; l < kLanes; ++l) {
    const Direction d = directions[std::min(l, count - 1)];
    const OpenTile& tile = tiles[d.tile];
    const std::size_t edge = d.edge();
    const double sign = tile.tile.up ? 1.0 : -1.0;
    const double x = tile.center.x() - f.center[0], y = tile.center.y() - f.center[1];
    if (d.way() >= kLeft) {
      const double side = d.way() == kLeft ? 1.0 : -1.0;
      to.ax[l] = side * f.normal_x[edge];
      to.ay[l] = side * f.normal_y[edge];
      to.c[l] = -side * polygon.line_offset[edge];
      to.turn[l] = 1.0;
      for (int j = 0; j < J; ++j) {
        to.bx[j][l] = x + sign * grid.corner[static_cast<std::size_t>(j)].x();
        to.by[j][l] = y + sign * grid.corner[static_cast<std::size_t>(j)].y();
      }
    } else {
      const Vec2 n = sign * grid.normal[d.way()];
      const std::size_t next = polygon.next[edge];
      to.ax[l] = n.x();
      to.ay[l] = n.y();
      to.c[l] = -(n.x() * x + n.y() * y) - grid.inradius_mm;
      to.turn[l] = -1.0;
      to.bx[0][l] = f.x[edge];
      to.by[0][l] = f.y[edge];
      for (int j = 1; j < J; ++j) {
        to.bx[j][l] = f.x[next];
        to.by[j][l] = f.y[next];
      }
    }
  }
}

template <int J>
[[gnu::always_inline]] inline void judge(const PreparedPolygon& polygon, const TileGrid& grid, const CellFrame& f, const OpenTile* tiles,
                                         const Direction* directions, std::size_t count, DirectionBlock& result) {
  Lanes<J> in;
  load<J>(polygon, grid, f, tiles, directions, count, in);
  const Vector ax = vector_at(in.ax), ay = vector_at(in.ay), c = vector_at(in.c), turn = vector_at(in.turn);
  const double hx = f.half[0], hy = f.half[1], ht = f.half[2];
  const Vector zero = {}, infinite = zero + 1e300, full_x = zero + hx, full_y = zero + hy;
  const Vector size_x = ax < zero ? -ax : ax, size_y = ay < zero ? -ay : ay;
  const Vector reach = size_x * hx + size_y * hy;
  Vector least_room = infinite, least_value = infinite, surest = infinite;
  Vector low_t = zero - ht, high_t = zero + ht;
  for (int j = 0; j < J; ++j) {
    const Vector bx = vector_at(in.bx[j]), by = vector_at(in.by[j]);
    const Vector value = ax * bx + ay * by + c;
    const Vector slope = turn * (ax * by - ay * bx);
    const Vector steep = slope < zero ? -slope : slope;
    const Vector spread = reach + steep * ht;
    const Vector slack = value + (f.pad_mm - f.inset_mm);
    const Vector room = slack + spread;
    const Vector sure = value - spread;
    least_room = room < least_room ? room : least_room;
    least_value = value < least_value ? value : least_value;
    surest = sure < surest ? sure : surest;
    // One comparison a selection: the compiler takes compound masks apart. The other axes are at their best.
    const Vector limit = (slack + reach) / steep;
    const Vector low = slope > zero ? -limit : low_t, high = slope < zero ? limit : high_t;
    low_t = low > low_t ? low : low_t;
    high_t = high < high_t ? high : high_t;
  }
  const Vector open_x = least_room / size_x - hx, open_y = least_room / size_y - hy;
  const Vector limit_x = open_x < full_x ? open_x : full_x, limit_y = open_y < full_y ? open_y : full_y;
  const Vector gx = -turn * ax, gy = -turn * ay;
  vector_at(result.low[0].data()) = gx > zero ? -limit_x : -full_x;
  vector_at(result.high[0].data()) = gx < zero ? limit_x : full_x;
  vector_at(result.low[1].data()) = gy > zero ? -limit_y : -full_y;
  vector_at(result.high[1].data()) = gy < zero ? limit_y : full_y;
  vector_at(result.low[2].data()) = low_t;
  vector_at(result.high[2].data()) = high_t;
  const Vector open_t = high_t - low_t;  // negative: no angle is left; on x and y the room says so
  vector_at(result.room.data()) = open_t < least_room ? open_t : least_room;
  vector_at(result.surest.data()) = surest;
  vector_at(result.value.data()) = least_value;
}

using Judge = void (*)(const PreparedPolygon&, const TileGrid&, const CellFrame&, const OpenTile*, const Direction*, std::size_t, DirectionBlock&);

#define TRISKIN_JUDGE(name, target)                                                                                                      \
  template <int J>                                                                                                                       \
  target void name(const PreparedPolygon& p, const TileGrid& g, const CellFrame& f, const OpenTile* t, const Direction* d, std::size_t n, \
                   DirectionBlock& r) {                                                                                                  \
    judge<J>(p, g, f, t, d, n, r);                                                                                                       \
  }
TRISKIN_JUDGE(judge_plain, )
#if defined(__x86_64__)
TRISKIN_JUDGE(judge_avx2, [[gnu::target("avx2")]])
TRISKIN_JUDGE(judge_avx512, [[gnu::target("avx512f,avx512dq,avx512vl")]])
#endif
#undef TRISKIN_JUDGE

template <int J>
Judge fastest() {
#if defined(__x86_64__)
  if (__builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq") && __builtin_cpu_supports("avx512vl")) return judge_avx512<J>;
  if (__builtin_cpu_supports("avx2")) return judge_avx2<J>;
#endif
  return judge_plain<J>;
}

}  // namespace

void CellFrame::set(const PreparedPolygon& polygon, const TileGrid& grid, const MotionBox& box, double inset, double sufficient) {
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
  pad_mm = 0.5 * lever * half[2] * half[2] + slide * half[2] + kRounding_mm;
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

void judge_directions(const PreparedPolygon& polygon, const TileGrid& grid, const CellFrame& frame, const OpenTile* tiles,
                      const Direction* directions, std::size_t count, DirectionBlock& result) {
  static const Judge kThree = fastest<3>(), kFour = fastest<4>(), kSix = fastest<6>();
  (grid.corners == 3 ? kThree : grid.corners == 4 ? kFour : kSix)(polygon, grid, frame, tiles, directions, count, result);
}

}  // namespace triskin::geometry
