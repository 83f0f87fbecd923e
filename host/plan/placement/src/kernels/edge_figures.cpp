// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernels/edge_figures.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "kernels/vector_unit.hpp"

namespace triskin::placement {
namespace {

constexpr std::size_t kEdges = EdgeArrays::kLanes;
constexpr double kLevel = 1e-4;     // A half plane bounds columns only when the x of its normal exceeds this.
constexpr double kSlack_mm = 1e-6;  // This is far above the rounding of coordinates and sample positions.
constexpr double kNoBound = 1e9;

using Vector = double __attribute__((vector_size(8 * kEdges), may_alias));
using Index = std::int32_t __attribute__((vector_size(4 * kEdges), may_alias));
using Single = float __attribute__((vector_size(4 * kEdges), may_alias));

// Holds eight edges as EdgeArrays stores them, with (x, y) the normal of the line.
struct Edges {
  Vector ax, ay, bx, by, x, y, offset, far;
};

// Holds one half plane per direction: sides of the tile, m·c ≥ limit, and lines n·c between low and high.
struct HalfPlanes {
  Vector side[6];
  Vector x[2], y[2], low[2], high[2];
};

// Bounds the columns of eight figures: column ≥ or ≤ at + slope·row, where row 0 is the first of each.
struct Lines {
  static constexpr std::size_t kMaxLines = 8;
  alignas(64) float at[kMaxLines][kEdges], slope[kMaxLines][kEdges];
  std::size_t count = 0;
};

struct Figures {
  Vector left, right, low, high;  // The boxes are in mm.
  Vector first, rows;             // The positions refer to the raster.
  Lines lower, upper;
};

// Vectors are passed by reference, because passing them by value depends on the instruction set.
[[gnu::always_inline]] inline void load(const std::vector<double>& from, std::size_t at, Vector& to) {
  std::memcpy(&to, from.data() + at, sizeof to);
}
[[gnu::always_inline]] inline void lesser(const Vector& a, const Vector& b, Vector& to) {
  to = b < a ? b : a;
}
[[gnu::always_inline]] inline void greater(const Vector& a, const Vector& b, Vector& to) {
  to = b > a ? b : a;
}
[[gnu::always_inline]] inline void size_of(const Vector& v, Vector& to) {
  to = v < Vector{} ? -v : v;
}
// Requires numbers over 0.
[[gnu::always_inline]] inline void round_down(const Vector& v, Vector& to) {
  to = __builtin_convertvector(__builtin_convertvector(v, Index), Vector);
}
[[gnu::always_inline]] inline void round_up(const Vector& v, Vector& to) {
  Vector whole;
  round_down(v, whole);
  to = whole < v ? whole + 1.0 : whole;
}

// Holds the corners of a tile that are farthest to the right and to the left of the edge.
struct Extremes {
  Vector right_x, right_y, left_x, left_y;
};
[[gnu::always_inline]] inline void find_extremes(const Edges& e, const TileGrid& grid, double sign, Extremes& to) {
  Vector least = Vector{} + 1e300, most = Vector{} - 1e300;
  for (std::size_t k = 0; k < static_cast<std::size_t>(grid.corners); ++k) {
    const Vector x = Vector{} + sign * grid.corner[k].x(), y = Vector{} + sign * grid.corner[k].y(),
                 v = e.x * x + e.y * y;
    to.right_x = v < least ? x : to.right_x;
    to.right_y = v < least ? y : to.right_y;
    to.left_x = v > most ? x : to.left_x;
    to.left_y = v > most ? y : to.left_y;
    lesser(least, v, least);
    greater(most, v, most);
  }
}

// Requires that both ends keep the separation beyond no side: at every motion (turned outwards, moved out), or at some.
[[gnu::always_inline]] inline void add_sides(const Edges& e, const TileGrid& grid, const FigureTerms& t, bool outer,
                                             const Vector& separation, HalfPlanes& to) {
  const double turn = outer ? -t.turn : t.turn;
  for (std::size_t k = 0; k < static_cast<std::size_t>(grid.corners); ++k) {
    const double mx = t.sign * grid.normal[k].x(), my = t.sign * grid.normal[k].y();
    const double slide = (outer ? -1.0 : 1.0) * (std::abs(mx) * t.half_x + std::abs(my) * t.half_y);
    Vector across_a, across_b, nearer;
    size_of(mx * e.ay - my * e.ax, across_a);
    size_of(mx * e.by - my * e.bx, across_b);
    lesser(mx * e.ax + my * e.ay + turn * across_a, mx * e.bx + my * e.by + turn * across_b, nearer);
    to.side[k] = nearer + (slide - grid.offset_mm[k]) - separation;
  }
}

// Requires that the corners of the tile do not all keep the separation to the left of the edge's line, nor all to the
// right. The cut uses the line turned by both ends of the range of angles: in between the value of a corner is linear.
[[gnu::always_inline]] inline void add_strips(const Edges& e, const TileGrid& grid, const FigureTerms& t, bool outer,
                                              const Vector& separation, HalfPlanes& to) {
  Extremes corners{};
  find_extremes(e, grid, t.sign, corners);
  Vector size_x, size_y, margin;
  size_of(e.x, size_x);
  size_of(e.y, size_y);
  const Vector slide = size_x * t.half_x + size_y * t.half_y;
  if (outer) {
    Vector along_a, along_b, lever, grown;
    size_of(e.y * e.ax - e.x * e.ay, along_a);
    size_of(e.y * e.bx - e.x * e.by, along_b);
    greater(along_a, along_b, lever);
    greater(Vector{}, separation, grown);
    margin = separation + slide + (lever + 3.0 * grid.circumradius_mm + grown) * t.turn;
  } else {
    margin = separation - slide;
  }
  for (int k = 0; k < (outer ? 1 : 2); ++k) {
    const double turn = outer ? 0.0 : k == 0 ? -t.turn : t.turn;
    to.x[k] = e.x - turn * e.y;
    to.y[k] = e.y + turn * e.x;
    to.high[k] = e.offset - (to.x[k] * corners.right_x + to.y[k] * corners.right_y) + margin;
    to.low[k] = e.offset - (to.x[k] * corners.left_x + to.y[k] * corners.left_y) - margin;
  }
}

// All centres of tiles that an edge can touch lie in a box around it, which bounds rows and words.
[[gnu::always_inline]] inline void set_box(const Edges& e, const Vector& room, Figures& to) {
  lesser(e.ax, e.bx, to.left);
  greater(e.ax, e.bx, to.right);
  lesser(e.ay, e.by, to.low);
  greater(e.ay, e.by, to.high);
  to.left -= room;
  to.right += room;
  to.low -= room;
  to.high += room;
}

// Handles low ≤ x*c.x + y*c.y ≤ high for a negligible x: the term is fixed with the worst c.x for the cut and the
// best for the rest.
[[gnu::always_inline]] inline void clip_level(const Vector& x, const Vector& y, const Vector& low, const Vector& high,
                                              bool outer, Figures& f) {
  Vector level, least, most, bottom, top, size;
  size_of(x, size);
  lesser(x * f.left, x * f.right, least);
  greater(x * f.left, x * f.right, most);
  const Vector at_low = (low - (outer ? most : least)) / y, at_high = (high - (outer ? least : most)) / y;
  bottom = (y > Vector{} ? at_low : at_high) - kSlack_mm;
  top = (y > Vector{} ? at_high : at_low) + kSlack_mm;
  greater(f.low, bottom, bottom);
  lesser(f.high, top, top);
  level = Vector{} + kLevel;
  f.low = size <= level ? bottom : f.low;
  f.high = size <= level ? top : f.high;
}

// Turns x·c.x + y·c.y ≤ v, or ≥ v, into a bound of columns; `lower` tells where it bounds them below.
[[gnu::always_inline]] inline void add_line(const FigureTerms& t, const Vector& x, const Vector& y, const Vector& v,
                                            bool outer, bool lower, Figures& f) {
  Lines& to = lower ? f.lower : f.upper;
  Vector size, at_size, slope_size;
  size_of(x, size);
  const Vector per_column = 1.0 / (x * t.step_x), tilt = -y * t.step_y * per_column;
  const Vector level = Vector{} + kLevel, none = Vector{} + (lower ? -kNoBound : kNoBound);
  const Vector from = t.column0 - v * per_column + tilt * (f.first - t.row0);
  size_of(from, at_size);
  size_of(tilt, slope_size);
  const Vector slack = 3e-7 * (at_size + slope_size * f.rows) + 1e-6;
  const Vector at = size <= level    ? none
                    : lower == outer ? from - slack
                                     : from + slack,
               slope = size <= level ? Vector{} : tilt;
  const Single at_single = __builtin_convertvector(at, Single), slope_single = __builtin_convertvector(slope, Single);
  std::memcpy(to.at[to.count], &at_single, sizeof at_single);
  std::memcpy(to.slope[to.count++], &slope_single, sizeof slope_single);
}

[[gnu::always_inline]] inline void bound(const HalfPlanes& planes, const TileGrid& grid, const FigureTerms& t,
                                         bool outer, Figures& f) {
  const Vector far = Vector{} + 1e300;
  const int strips = outer ? 1 : 2;
  for (int k = 0; k < grid.corners; ++k) {
    const Vec2& m = grid.normal[static_cast<std::size_t>(k)];
    if (std::abs(m.x()) <= kLevel)
      clip_level(Vector{} + t.sign * m.x(), Vector{} + t.sign * m.y(), planes.side[k], far, outer, f);
  }
  for (int k = 0; k < strips; ++k) clip_level(planes.x[k], planes.y[k], planes.low[k], planes.high[k], outer, f);
  Vector end;
  const double per_row = 1.0 / t.step_y;
  round_up(t.row0 - f.high * per_row, f.first);
  round_down(t.row0 - f.low * per_row, end);
  f.rows = end - f.first + 1.0;
  for (int k = 0; k < grid.corners; ++k) {
    const double x = t.sign * grid.normal[static_cast<std::size_t>(k)].x(),
                 y = t.sign * grid.normal[static_cast<std::size_t>(k)].y();
    // Lower columns lie to the right.
    if (std::abs(x) > kLevel) add_line(t, Vector{} + x, Vector{} + y, planes.side[k], outer, x < 0.0, f);
  }
  for (int k = 0; k < strips; ++k) {
    const Vector none = {};
    const Vector right = planes.x[k] > none ? planes.high[k] : planes.low[k],
                 left = planes.x[k] > none ? planes.low[k] : planes.high[k];
    add_line(t, planes.x[k], planes.y[k], right, outer, true, f);
    add_line(t, planes.x[k], planes.y[k], left, outer, false, f);
  }
}

// Makes the figures of eight edges. Inside a part the remainder of Taylor's formula is at most (far·turn/2 +
// slide)·turn.
[[gnu::always_inline]] inline void make_figures(const Edges& e, const TileGrid& grid, const FigureTerms& t, bool outer,
                                                Figures& to) {
  const double slide = std::sqrt(t.half_x * t.half_x + t.half_y * t.half_y), beyond = 3.0 * grid.circumradius_mm;
  const Vector far = e.far + beyond, pad = (0.5 * far * t.turn + slide) * t.turn + kSlack_mm;
  const Vector separation = outer ? t.separation_mm + pad : t.separation_mm - pad;
  Vector room = Vector{} + (grid.circumradius_mm + kSlack_mm);
  if (outer) {
    // A tile whose sides have moved out by this much extends farther at its corners.
    Vector moved;
    greater(Vector{}, separation + slide + t.turn * far, moved);
    room = grid.circumradius_mm * (1.0 + moved * (1.0 / grid.inradius_mm)) + kSlack_mm;
  }
  set_box(e, room, to);
  HalfPlanes planes;
  add_sides(e, grid, t, outer, separation, planes);
  add_strips(e, grid, t, outer, separation, planes);
  to.lower.count = to.upper.count = 0;
  bound(planes, grid, t, outer, to);
}

constexpr int kRows = SampleBits::kBlock;
using Reals = float __attribute__((vector_size(4 * kRows)));
using Whole = std::int32_t __attribute__((vector_size(4 * kRows)));
using Words = std::uint32_t __attribute__((vector_size(4 * kRows)));

// Finds columns [begin, end) of sixteen rows from `first` on that lie between the bounds: strictly inside, or (outer)
// with up to one more on either side. Columns below 0 are cut off; begin ≥ end means none.
[[gnu::always_inline]] inline void spans(const Figures& f, std::size_t lane, int first, int rows, bool outer,
                                         Whole& begin, Whole& end) {
  const Reals zero = {}, number = {0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15};
  const Reals row = number + static_cast<float>(first);
  Reals low = zero, high = zero + static_cast<float>(kNoBound);
  for (std::size_t k = 0; k < f.lower.count; ++k) {
    const Reals v = f.lower.at[k][lane] + f.lower.slope[k][lane] * row;
    low = v > low ? v : low;
  }
  for (std::size_t k = 0; k < f.upper.count; ++k) {
    const Reals v = f.upper.at[k][lane] + f.upper.slope[k][lane] * row;
    high = v < high ? v : high;
  }
  high = high < low ? low - 3.0F : high;  // high < low marks an empty range.
  low = low < static_cast<float>(kNoBound) ? low : zero + static_cast<float>(kNoBound);
  const int room = outer ? 1 : 0;
  begin = __builtin_convertvector(low, Whole) + (1 - room);
  end = __builtin_convertvector(high + 4.0F, Whole) - (3 - room);
  end = row < static_cast<float>(rows) ? end : begin;
}

// Sets the bits below `column`.
[[gnu::always_inline]] inline void ones_below(const Whole& column, Words& to) {
  const Words none = {};
  to = ((none + 1U) << __builtin_convertvector(column & (SampleBits::kWord - 1), Words)) - 1U;
  to = column < SampleBits::kWord ? to : none - 1U;
  to = column > 0 ? to : none;
}

[[gnu::always_inline]] inline void fill(const Figures& f, std::size_t lane, const FigureTerms& t, bool outer,
                                        SampleBits& bits) {
  const int rows = static_cast<int>(f.rows[lane]), first_row = static_cast<int>(f.first[lane]);
  if (rows <= 0) return;
  const int first_column = static_cast<int>(t.column0 - f.right[lane] / t.step_x),
            last_column = static_cast<int>(t.column0 - f.left[lane] / t.step_x) + 1;
  const int first_word = first_column / SampleBits::kWord, last_word = last_column / SampleBits::kWord;
  for (int first = 0; first < rows; first += kRows) {
    Whole begin, end;
    spans(f, lane, first, rows, outer, begin, end);
    for (int w = first_word; w <= last_word; ++w) {
      std::uint32_t* at = bits.word(first_row + first, w);
      Words before, until, to;
      ones_below(begin - SampleBits::kWord * w, before);
      ones_below(end - SampleBits::kWord * w, until);
      std::memcpy(&to, at, sizeof to);
      to |= until & ~before;
      std::memcpy(at, &to, sizeof to);
    }
  }
}

[[gnu::always_inline]] inline void fill_all(const EdgeArrays& edges, const TileGrid& grid, const FigureTerms& t,
                                            bool outer, SampleBits& bits) {
  for (std::size_t at = 0; at < edges.count; at += kEdges) {
    Edges e;
    load(edges.ax, at, e.ax);
    load(edges.ay, at, e.ay);
    load(edges.bx, at, e.bx);
    load(edges.by, at, e.by);
    load(edges.normal_x, at, e.x);
    load(edges.normal_y, at, e.y);
    load(edges.offset, at, e.offset);
    load(edges.far, at, e.far);
    Figures figures;
    make_figures(e, grid, t, outer, figures);
    for (std::size_t lane = 0; lane < std::min(kEdges, edges.count - at); ++lane) fill(figures, lane, t, outer, bits);
  }
}

using Fill = void (*)(const EdgeArrays&, const TileGrid&, const FigureTerms&, bool, SampleBits&);

#define TRISKIN_FILL(unit, target)                                                                  \
  target void fill_##unit(const EdgeArrays& e, const TileGrid& g, const FigureTerms& t, bool outer, \
                          SampleBits& bits) {                                                       \
    if (outer)                                                                                      \
      fill_all(e, g, t, true, bits);                                                                \
    else                                                                                            \
      fill_all(e, g, t, false, bits);                                                               \
  }
TRISKIN_FOR_VECTOR_UNITS(TRISKIN_FILL)
#undef TRISKIN_FILL

}  // namespace

EdgeArrays::EdgeArrays(const PreparedPolygon& polygon) : count(polygon.edges.size()) {
  const std::size_t size = (count + kLanes - 1) / kLanes * kLanes;
  for (std::vector<double>* v : {&ax, &ay, &bx, &by, &normal_x, &normal_y}) v->resize(size);
  for (std::size_t k = 0; k < size; ++k) {
    const std::size_t edge = std::min(k, count - 1);
    offset.push_back(polygon.line_offset[edge]);
    far.push_back(std::max(polygon.edges[edge][0].norm(), polygon.edges[edge][1].norm()));
  }
}

void EdgeArrays::move(const PreparedPolygon& polygon, const CellFrame& frame) {
  for (std::size_t k = 0; k < offset.size(); ++k) {
    const std::size_t edge = std::min(k, count - 1), next = polygon.next[edge];
    ax[k] = frame.x[edge];
    ay[k] = frame.y[edge];
    bx[k] = frame.x[next];
    by[k] = frame.y[next];
    normal_x[k] = frame.normal_x[edge];
    normal_y[k] = frame.normal_y[edge];
  }
}

void fill_figures(const EdgeArrays& edges, const TileGrid& grid, const FigureTerms& terms, bool outer,
                  SampleBits& bits) {
  static const Fill kFill = fastest(fill_plain, fill_avx2, fill_avx512);
  kFill(edges, grid, terms, outer, bits);
}

}  // namespace triskin::placement
