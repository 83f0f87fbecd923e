// SPDX-License-Identifier: GPL-3.0-or-later
#include "placement/kernels/slice_raster.hpp"

#include <algorithm>

namespace triskin::geometry {
namespace {

constexpr double kLevel = 1e-4;     // a normal's x from which on a half plane bounds columns
constexpr double kSlack_mm = 1e-6;  // far above the rounding of coordinates and sample positions

// Each bit becomes the parity of itself and all lower ones.
std::uint64_t running_parity(std::uint64_t v) {
  for (int shift = 1; shift < 64; shift *= 2) v ^= v << shift;
  return v;
}

double cross(const Vec2& a, const Vec2& b) {
  return a.x() * b.y() - a.y() * b.x();
}

}  // namespace

// The moved polygon with room for every tile that an edge can touch, wherever in its cell the lattice lies.
void SliceRaster::set_window(const CellFrame& f) {
  step_x_ = grid_.row_step_mm / kSteps;
  step_y_ = grid_.row_height_mm / kSteps;
  const auto [low_x, high_x] = std::ranges::minmax(f.x);
  const auto [low_y, high_y] = std::ranges::minmax(f.y);
  // The figures of touched tiles reach a little farther than a tile; every tile that has a sample there is seen whole.
  const double change = f.certain_mm + f.pad_mm + f.reach_mm - std::hypot(f.half[0], f.half[1]) +
                        4.0 * grid_.circumradius_mm * f.half[2] + step_x_ + step_y_;
  const double room = grid_.circumradius_mm * (1.5 + std::max(0.0, change) / grid_.inradius_mm) +
                      std::max(grid_.row_step_mm, grid_.row_height_mm);
  first_column_ = static_cast<int>(std::ceil((high_x + room) / step_x_));
  first_row_ = static_cast<int>(std::ceil((high_y + room) / step_y_));
  shift_steps_ = static_cast<int>(std::lround(grid_.row_shift_mm / step_x_));
  columns_ = first_column_ - static_cast<int>(std::floor((low_x - room) / step_x_));
  rows_ = first_row_ - static_cast<int>(std::floor((low_y - room) / step_y_));
  words_ = static_cast<std::size_t>(columns_) / 64 + 2;
}

void SliceRaster::scan(const CellFrame& frame) {
  set_window(frame);
  certain_ = 0;
  border_.clear();
  planes_.clear();
  for (int up = 2 - grid_.kinds; up < 2; ++up) {
    Kind& kind = kinds_[static_cast<std::size_t>(up)];
    kind.first = grid_.origin[static_cast<std::size_t>(up)] - 0.5 * Vec2(step_x_, step_y_);
    for (auto& bits : kind.bits) bits.assign(words_ * static_cast<std::size_t>(rows_), 0);
    scan_inside(frame, kind);
    for (std::size_t k = 0; k < frame.x.size(); ++k) scan_edge(frame, k, up != 0 ? 1.0 : -1.0, kind);
    collect(up != 0);
  }
  counts_.fill(0);
  for (std::size_t p = 0; p < planes_.size(); ++p) {
    for (std::size_t k = 0; k < counts_.size(); ++k)
      counts_[k] += static_cast<int>((planes_[p][k / kSteps] >> (k % kSteps)) & 1U) << p;
  }
}

// Parity of the crossings to the right of each sample. Each vertex belongs to one row, so that every row is crossed
// evenly often; where along the row matters little, for whatever lies near the outline is cut.
void SliceRaster::scan_inside(const CellFrame& f, Kind& kind) {
  auto& bits = kind.bits[kInside];
  row_of_.clear();
  for (const double y : f.y)
    row_of_.push_back(static_cast<int>(std::ceil((kind.first.y() - y) / step_y_)) + first_row_);
  for (std::size_t k = 0; k < f.x.size(); ++k) {
    const std::size_t next = polygon_.next[k], top = row_of_[k] < row_of_[next] ? k : next,
                      bottom = top == k ? next : k;
    if (row_of_[top] == row_of_[bottom]) continue;
    // Row r samples the height first + step·(first_row − r).
    const double slope = (f.x[bottom] - f.x[top]) / (f.y[bottom] - f.y[top]);
    const double height = kind.first.y() + step_y_ * (first_row_ - row_of_[top]);
    const double x = f.x[top] + (height - f.y[top]) * slope;
    const double step = step_y_ * slope / step_x_;
    double at = (kind.first.x() - x) / step_x_ + first_column_ + 1;
    std::uint64_t* row = bits.data() + static_cast<std::size_t>(row_of_[top]) * words_;
    for (int r = row_of_[top]; r < row_of_[bottom]; ++r, at += step, row += words_) {
      const auto column = static_cast<std::uint32_t>(static_cast<int>(at));
      row[column / 64] ^= std::uint64_t{1} << (column % 64);
    }
  }
  for (std::size_t r = 0; r < bits.size(); r += words_) {
    std::uint64_t carry = 0;
    for (std::size_t w = r; w < r + words_; ++w) {
      if ((bits[w] | carry) == 0) continue;
      bits[w] = bits[w] == 0 ? carry : running_parity(bits[w]) ^ carry;
      carry = (bits[w] >> 63) != 0 ? ~std::uint64_t{0} : 0;
    }
  }
}

// A tile of centre c is cut at every motion in a part when every direction fails there; each failure is a half plane
// for c. The turn acts on a line as two half planes, one for each end of the range of angles: it is linear between
// them.
void SliceRaster::scan_edge(const CellFrame& f, std::size_t edge, double sign, Kind& kind) {
  const std::size_t next = polygon_.next[edge];
  const Vec2 a(f.x[edge], f.y[edge]), b(f.x[next], f.y[next]), n(f.normal_x[edge], f.normal_y[edge]),
      along(n.y(), -n.x());
  const Vec2 half(f.half[0] / kSteps, f.half[1] / kSteps);
  const double turn = f.half[2], slide = half.norm(), far = std::max(a.norm(), b.norm()) + 3.0 * grid_.circumradius_mm;
  const double pad = (0.5 * far * turn + slide) * turn + kSlack_mm;
  const double cut = f.inset_mm - pad, touched = f.certain_mm + pad;
  touched_room_mm_ = grid_.circumradius_mm * (1.0 + std::max(0.0, touched + slide + turn * far) / grid_.inradius_mm);
  const double lever =
      std::max(std::abs(along.dot(a)), std::abs(along.dot(b))) + 3.0 * grid_.circumradius_mm + std::max(0.0, touched);
  cut_.clear();
  touched_.clear();
  for (int k = 0; k < grid_.corners; ++k) {
    const Vec2 m = sign * grid_.normal[static_cast<std::size_t>(k)];
    const double spread = m.cwiseAbs().dot(half), offset_mm = grid_.offset_mm[static_cast<std::size_t>(k)],
                 ma = m.dot(a), mb = m.dot(b), turn_a = turn * std::abs(cross(m, a)),
                 turn_b = turn * std::abs(cross(m, b));
    // Beyond the side by `touched` whatever the motion, or nowhere by `cut`.
    touched_.push_back({-m, -(std::min(ma - turn_a, mb - turn_b) - spread - offset_mm - touched)});
    cut_.push_back({-m, -(std::min(ma + turn_a, mb + turn_b) + spread - offset_mm - cut)});
  }
  double least = 1e300, most = -1e300;
  Vec2 right = Vec2::Zero(), left = right;
  for (int k = 0; k < grid_.corners; ++k) {
    const Vec2 corner = sign * grid_.corner[static_cast<std::size_t>(k)];
    if (n.dot(corner) < least) right = corner;
    if (n.dot(corner) > most) left = corner;
    least = std::min(least, n.dot(corner));
    most = std::max(most, n.dot(corner));
  }
  const double spread = n.cwiseAbs().dot(half), offset = polygon_.line_offset[edge];
  touched_.push_back({n, offset - least + spread + lever * turn + touched});
  touched_.push_back({-n, -(offset - most - spread - lever * turn - touched)});
  for (const double t : {-turn, turn}) {
    // Value of a corner: n·q − offset + t·(n × q), q = c + corner.
    const Vec2 turned = n + t * Vec2(-n.y(), n.x());
    cut_.push_back({turned, offset - turned.dot(right) + cut - spread});
    cut_.push_back({-turned, -offset + turned.dot(left) + cut - spread});
  }
  fill(a, b, cut_, false, kind, kind.bits[kCut]);
  fill(a, b, touched_, true, kind, kind.bits[kTouched]);
}

// Samples in all half planes, which lie near the edge: a few more where the figure is touched, a few less where it is
// cut.
void SliceRaster::fill(const Vec2& a, const Vec2& b, const std::vector<HalfPlane>& planes, bool outer, const Kind& kind,
                       std::vector<std::uint64_t>& bits) {
  const double room = (outer ? touched_room_mm_ : grid_.circumradius_mm) + kSlack_mm;
  double low = std::min(a.y(), b.y()) - room, high = std::max(a.y(), b.y()) + room;
  const double left = std::min(a.x(), b.x()) - room, right = std::max(a.x(), b.x()) + room;
  for (const auto& [normal, limit] : planes) {
    if (std::abs(normal.x()) > kLevel) continue;
    // Nearly level: as if it were, with the worst x for the cut and the best for the rest.
    const double x = std::max(normal.x() * left, normal.x() * right),
                 shift = outer ? std::min(normal.x() * left, normal.x() * right) : x;
    if (normal.y() > 0.0)
      high = std::min(high, (limit - shift) / normal.y() + kSlack_mm);
    else
      low = std::max(low, (limit - shift) / normal.y() - kSlack_mm);
  }
  const int first = static_cast<int>(std::ceil((kind.first.y() - high) / step_y_)) + first_row_;
  const int rows = static_cast<int>(std::floor((kind.first.y() - low) / step_y_)) + first_row_ + 1 - first;
  if (rows <= 0) return;
  lines_.lower.clear();
  lines_.upper.clear();
  const double top = kind.first.y() + step_y_ * (first_row_ - first);
  for (const auto& [normal, limit] : planes) {
    if (std::abs(normal.x()) <= kLevel) continue;
    // x ≤ (limit − normal.y·y)/normal.x: columns count to the left, rows downwards.
    const double at = (kind.first.x() - (limit - normal.y() * top) / normal.x()) / step_x_ + first_column_;
    const double slope = -normal.y() * step_y_ / normal.x() / step_x_;
    const double slack = (outer ? -1.0 : 1.0) * (3e-7 * (std::abs(at) + std::abs(slope) * rows) + 1e-6);
    if (normal.x() > 0.0)
      lines_.lower.push_back({static_cast<float>(at + slack), static_cast<float>(slope)});
    else
      lines_.upper.push_back({static_cast<float>(at - slack), static_cast<float>(slope)});
  }
  row_spans(lines_, rows, outer ? 1 : 0, begin_, end_);
  for (int r = 0; r < rows; ++r)
    fill_row(bits.data() + static_cast<std::size_t>(first + r) * words_, begin_[static_cast<std::size_t>(r)],
             end_[static_cast<std::size_t>(r)]);
}

void SliceRaster::fill_row(std::uint64_t* words, std::int32_t begin, std::int32_t end) {
  if (begin >= end) return;
  const auto from = static_cast<std::size_t>(begin), last = static_cast<std::size_t>(end - 1);
  const std::uint64_t head = ~std::uint64_t{0} << (from % 64), tail = ~std::uint64_t{0} >> (63 - last % 64);
  if (from / 64 == last / 64) {
    words[from / 64] |= head & tail;
    return;
  }
  words[from / 64] |= head;
  for (std::size_t w = from / 64 + 1; w < last / 64; ++w) words[w] = ~std::uint64_t{0};
  words[last / 64] |= tail;
}

std::uint32_t SliceRaster::bits_at(const std::vector<std::uint64_t>& bits, int row, int column) const {
  const std::uint64_t* word =
      bits.data() + static_cast<std::size_t>(row) * words_ + static_cast<std::size_t>(column) / 64;
  const std::size_t shift = static_cast<std::size_t>(column) % 64;
  return static_cast<std::uint32_t>((word[0] >> shift) | (shift > 64 - kSteps ? word[1] << (64 - shift) : 0)) & kFull;
}

// Tile by tile: outside or cut in all parts, certain in all, or a border tile.
void SliceRaster::collect(bool up) {
  const Kind& kind = kinds_[up ? 1 : 0];
  for (int j = (first_row_ - rows_) / kSteps; kSteps * j <= first_row_; ++j) {
    const int row = first_row_ - kSteps * j;
    if (row + kSteps > rows_) continue;
    near_.assign(words_, 0);
    for (int k = 0; k < kSteps; ++k) {
      const std::uint64_t* words = kind.bits[kTouched].data() + static_cast<std::size_t>(row + k) * words_;
      for (std::size_t w = 0; w < words_; ++w) near_[w] |= words[w];
    }
    const int origin = first_column_ - shift_steps_ * j;
    for (int i = (origin - columns_) / kSteps; kSteps * i <= origin; ++i) {
      const int column = origin - kSteps * i;
      if (column + kSteps > columns_) continue;
      if (bits_at(near_, 0, column) == 0)
        certain_ += static_cast<int>(bits_at(kind.bits[kInside], row, column) & 1U);
      else
        collect_near({i, j, up}, kind, row, column);
    }
  }
}

void SliceRaster::collect_near(const Tile& tile, const Kind& kind, int row, int column) {
  Border border{tile, {}, {}};
  std::uint32_t any = 0, all = kFull;
  for (int k = 0; k < kSteps; ++k) {
    const auto at = static_cast<std::size_t>(k);
    const std::uint32_t inside = bits_at(kind.bits[kInside], row + k, column);
    if (inside != 0) {
      border.may[at] = inside & ~bits_at(kind.bits[kCut], row + k, column);
      border.must[at] = inside & ~bits_at(kind.bits[kTouched], row + k, column);
    }
    any |= border.may[at];
    all &= border.must[at];
  }
  if (all == kFull)
    ++certain_;
  else if (any != 0) {
    add_to_counts(border.may);
    border_.push_back(border);
  }
}

// Adds one to the count of every part whose bit is set: binary digits in planes, all parts at once.
void SliceRaster::add_to_counts(const Rows& may) {
  Rows carry = may;
  for (std::size_t p = 0;; ++p) {
    if (p == planes_.size()) planes_.push_back({});
    std::uint32_t any = 0;
    for (std::size_t k = 0; k < carry.size(); ++k) {
      const std::uint32_t both = planes_[p][k] & carry[k];
      planes_[p][k] ^= carry[k];
      carry[k] = both;
      any |= both;
    }
    if (any == 0) return;
  }
}

}  // namespace triskin::geometry
