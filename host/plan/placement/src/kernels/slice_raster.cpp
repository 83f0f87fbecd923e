// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernels/slice_raster.hpp"

#include <algorithm>

namespace triskin::placement {
namespace {

int round_up(int v, int step) {
  return (v + step - 1) / step * step;
}

}  // namespace

// Sets the window to the moved polygon with room for every tile that an edge can touch, wherever in its cell the
// lattice lies.
void SliceRaster::set_window(const CellFrame& f) {
  step_x_ = grid_.row_step_mm / kSteps;
  step_y_ = grid_.row_height_mm / kSteps;
  const auto [low_x, high_x] = std::ranges::minmax(f.x);
  const auto [low_y, high_y] = std::ranges::minmax(f.y);
  // The figures of touched tiles extend a little farther than a tile; every tile that has a sample there is covered
  // completely.
  const double change = f.certain_mm + f.pad_mm + f.reach_mm - std::hypot(f.half[0], f.half[1]) +
                        4.0 * grid_.circumradius_mm * f.half[2] + step_x_ + step_y_;
  const double room = grid_.circumradius_mm * (1.5 + std::max(0.0, change) / grid_.inradius_mm) +
                      std::max(grid_.row_step_mm, grid_.row_height_mm);
  first_column_ = round_up(static_cast<int>(std::ceil((high_x + room) / step_x_)), SampleBits::kWord);
  first_row_ = round_up(static_cast<int>(std::ceil((high_y + room) / step_y_)), kSteps);
  shift_steps_ = static_cast<int>(std::lround(grid_.row_shift_mm / step_x_));
  words_ = (first_column_ - static_cast<int>(std::floor((low_x - room) / step_x_))) / SampleBits::kWord + 2;
  rows_ = round_up(first_row_ - static_cast<int>(std::floor((low_y - room) / step_y_)), kSteps);
}

void SliceRaster::scan(const CellFrame& frame) {
  set_window(frame);
  edges_.move(polygon_, frame);
  certain_.clear();
  for (BitCounts& sum : sums_) sum.clear();
  for (int up = 2 - grid_.kinds; up < 2; ++up) {
    Kind& kind = kinds_[static_cast<std::size_t>(up)];
    set_terms(frame, up != 0, kind.terms);
    for (const Layer layer : {kInside, kCut}) kind.bits[layer].clear(rows_, words_);
    scan_inside(frame, kind);
    kind.terms.separation_mm = frame.inset_mm;
    fill_figures(edges_, grid_, kind.terms, false, kind.bits[kCut]);
  }
  // Row of tiles j begins in row first_row − 16·j, and shift·j columns to the left of row 0.
  for (int up = 2 - grid_.kinds; up < 2; ++up) {
    const auto& bits = kinds_[static_cast<std::size_t>(up)].bits;
    for (int odd = 0; odd < 2; ++odd)
      sums_[static_cast<std::size_t>(odd)].add(bits[kInside], bits[kCut], (first_row_ / kSteps + odd) % 2);
  }
  counts_ = {};
  sums_[0].add_to(counts_, 0);
  sums_[1].add_to(counts_, shift_steps_);
}

void SliceRaster::set_terms(const CellFrame& frame, bool up, FigureTerms& to) const {
  const Vec2 first = grid_.origin[up ? 1 : 0] - 0.5 * Vec2(step_x_, step_y_);
  to.sign = up ? 1.0 : -1.0;
  to.column0 = first.x() / step_x_ + first_column_;
  to.row0 = first.y() / step_y_ + first_row_;
  to.step_x = step_x_;
  to.step_y = step_y_;
  to.half_x = frame.half[0] / kSteps;
  to.half_y = frame.half[1] / kSteps;
  to.turn = frame.half[2];
}

// Takes the parity of the crossings to the right of each sample. Each vertex belongs to one row, so every row is
// crossed an even number of times. The exact place along the row matters little, because everything near the outline is
// cut.
void SliceRaster::scan_inside(const CellFrame& f, Kind& kind) {
  SampleBits& bits = kind.bits[kInside];
  row_of_.clear();
  for (const double y : f.y) row_of_.push_back(static_cast<int>(std::ceil(kind.terms.row0 - y / step_y_)));
  for (std::size_t k = 0; k < f.x.size(); ++k) {
    const std::size_t next = polygon_.next[k], top = row_of_[k] < row_of_[next] ? k : next,
                      bottom = top == k ? next : k;
    if (row_of_[top] == row_of_[bottom]) continue;
    const double slope = (f.x[bottom] - f.x[top]) / (f.y[bottom] - f.y[top]);
    const double height = step_y_ * (kind.terms.row0 - row_of_[top]);
    const double x = f.x[top] + (height - f.y[top]) * slope;
    const double step = step_y_ * slope / step_x_;
    double at = kind.terms.column0 - x / step_x_ + 1;
    for (int r = row_of_[top]; r < row_of_[bottom]; ++r, at += step)
      bits.flip(r, static_cast<std::uint32_t>(static_cast<int>(at)));
  }
  bits.accumulate_parity();
}

void SliceRaster::collect(const CellFrame& frame) {
  border_.clear();
  for (int up = 2 - grid_.kinds; up < 2; ++up) {
    Kind& kind = kinds_[static_cast<std::size_t>(up)];
    kind.bits[kTouched].clear(rows_, words_);
    kind.terms.separation_mm = frame.certain_mm;
    fill_figures(edges_, grid_, kind.terms, true, kind.bits[kTouched]);
    collect_kind(up != 0);
  }
}

// Sorts each tile: outside or cut in all parts, certain in all, or a border tile.
void SliceRaster::collect_kind(bool up) {
  const int columns = (words_ - 1) * SampleBits::kWord;
  for (int j = (first_row_ - rows_) / kSteps + 1; kSteps * j <= first_row_; ++j) {
    const int origin = first_column_ - shift_steps_ * j;
    for (int column = origin & (kSteps - 1); column <= columns; column += kSteps)
      collect_tile({(origin - column) / kSteps, j, up}, kinds_[up ? 1 : 0], first_row_ - kSteps * j, column);
  }
}

// Takes columns [column, column + 16) of the rows from `row` on.
void SliceRaster::take_rows(const SampleBits& bits, int row, int column, BlockWords& to) {
  const int shift = column % SampleBits::kWord;
  std::memcpy(&to, bits.word(row, column / SampleBits::kWord), sizeof to);
  to >>= shift;
  if (shift > SampleBits::kWord - kSteps) {
    BlockWords next;
    std::memcpy(&next, bits.word(row, column / SampleBits::kWord + 1), sizeof next);
    to |= next << (SampleBits::kWord - shift);
  }
  to &= kFull;
}

void SliceRaster::collect_tile(const Tile& tile, const Kind& kind, int row, int column) {
  BlockWords inside, cut, touched;
  take_rows(kind.bits[kInside], row, column, inside);
  if (!any(inside)) return;
  take_rows(kind.bits[kCut], row, column, cut);
  take_rows(kind.bits[kTouched], row, column, touched);
  const BlockWords may = inside & ~cut, must = inside & ~touched;
  if (!any(must ^ kFull)) {
    certain_.push_back(tile);
  } else if (any(may)) {
    Border& border = border_.emplace_back();
    border.tile = tile;
    std::memcpy(border.may.data(), &may, sizeof may);
    std::memcpy(border.must.data(), &must, sizeof must);
  }
}

}  // namespace triskin::placement
