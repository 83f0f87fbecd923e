// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernels/weighted_tiles.hpp"

#include <algorithm>
#include <cmath>

namespace triskin::placement {
namespace {

constexpr double kRounding = 1e-12;  // This bounds the relative rounding of sums of some thousand terms.

// A block of this many parts along x and y has one first-order function of its tiles.
constexpr int kBlockParts = 4;
constexpr std::uint32_t kBlockBits = (1U << kBlockParts) - 1;

}  // namespace

double WeightedTiles::value(const Motion& m, const std::vector<Tile>& inside) {
  const double c = std::cos(m.theta), s = std::sin(m.theta);
  double sum = 0.0;
  for (const Tile& t : inside) {
    const Vec2 p = grid_.center(t) - Vec2(m.x, m.y);
    sum += map_.at(Vec2(c * p.x() + s * p.y(), -s * p.x() + c * p.y()) + polygon_.first + polygon_.center).value;
  }
  return sum;
}

WeightedTiles::Term& WeightedTiles::Term::operator+=(const Term& other) {
  value += other.value;
  rest += other.rest;
  for (std::size_t k = 0; k < 3; ++k) slope[k] += other.slope[k];
  return *this;
}

double WeightedTiles::Term::most(const std::array<double, 3>& offset, const std::array<double, 3>& half) const {
  double sum = value + rest;
  for (std::size_t k = 0; k < 3; ++k) sum += slope[k] * offset[k] + std::abs(slope[k]) * half[k];
  return sum;
}

// The centre of a tile, seen from the polygon, is q = Rᵀ(c − t): ∂q/∂t = −Rᵀ, ∂q/∂θ = (q_y, −q_x).
// It moves by at most `far` in the range; the first order omits `bend` of that.
WeightedTiles::Term WeightedTiles::term(const Range& r, const Vec2& center) const {
  const Vec2 p = center - Vec2(r.center[0], r.center[1]);
  const Vec2 q(r.cosine * p.x() + r.sine * p.y(), -r.sine * p.x() + r.cosine * p.y());
  const WeightMap::Jet jet = map_.at(q + polygon_.first + polygon_.center);
  const Vec2 turned(r.cosine * jet.slope_per_mm.x() - r.sine * jet.slope_per_mm.y(),
                    r.sine * jet.slope_per_mm.x() + r.cosine * jet.slope_per_mm.y());
  const double lever = q.norm();
  const double far = r.slide_mm + lever * r.half[2], bend = (0.5 * lever * r.half[2] + r.slide_mm) * r.half[2];
  const double curvature = far <= map_.step_mm() ? jet.near_curvature_per_mm2 : map_.max_curvature_per_mm2();
  return {jet.value,
          {-turned.x(), -turned.y(), jet.slope_per_mm.x() * q.y() - jet.slope_per_mm.y() * q.x()},
          map_.max_slope_per_mm() * bend + 0.5 * curvature * far * far};
}

// No weight is negative, so the sum over certain and open tiles bounds every sum in which open ones are missing.
double WeightedTiles::bound(const CellFrame& f, const std::vector<OpenTile>& certain,
                            const std::vector<OpenTile>& open) {
  const Range range{f.center, f.half, f.cosine, f.sine, std::hypot(f.half[0], f.half[1])};
  constexpr std::array<double, 3> kMiddle{};
  certain_sum_ = {};
  double each = 0.0;
  for (const OpenTile& t : certain) {
    const Term one = term(range, t.center);
    certain_sum_ += one;
    each += std::min(map_.most(), one.most(kMiddle, f.half));
  }
  certain_ = std::min(each, certain_sum_.most(kMiddle, f.half));
  open_terms_.clear();
  open_.clear();
  Term sum = certain_sum_;
  each = certain_;
  for (const OpenTile& t : open) {
    const Term& one = open_terms_.emplace_back(term(range, t.center));
    sum += one;
    open_.push_back(std::clamp(one.most(kMiddle, f.half), 0.0, map_.most()));
    each += open_.back();
  }
  middle_ = sum.value * (1.0 + kRounding);
  return std::min(each, sum.most(kMiddle, f.half)) * (1.0 + kRounding);
}

void WeightedTiles::bound_cubes(const PartsView& view, const std::vector<PartWord>& words, CubeBounds& bounds) const {
  std::array<Term, kCubes> sums;
  sums.fill(certain_sum_);
  for (std::size_t t = 0; t < words.size(); ++t) {
    for (std::size_t lane = 0; lane < kLanesPerRow; ++lane) {
      for (std::size_t row = 0; row < kPartsPerAxis; ++row) {
        if ((words[t][lane] >> row & 1U) != 0) sums[lane + kLanesPerRow * row] += open_terms_[t];
      }
    }
  }
  std::array<double, 3> half{}, first{};
  for (std::size_t k = 0; k < 3; ++k) {
    half[k] = view.half[k] / kPartsPerAxis;
    first[k] = view.shift[k] - view.half[k] + half[k];
  }
  for (std::size_t n = 0; n < kCubes; ++n) {
    const std::array<std::size_t, 3> at{n % kPartsPerAxis, n / kPartsPerAxis % kPartsPerAxis, n / kLanesPerRow};
    std::array<double, 3> offset{};
    for (std::size_t k = 0; k < 3; ++k) offset[k] = first[k] + 2.0 * static_cast<double>(at[k]) * half[k];
    bounds[n] = sums[n].most(offset, half) * (1.0 + kRounding);
  }
}

void WeightedTiles::bound_parts(const CellFrame& slice, const SliceRaster& raster, PartBounds& bounds) {
  constexpr int kBlocks = SliceRaster::kSteps / kBlockParts;
  const double half_x = slice.half[0] / kBlocks, half_y = slice.half[1] / kBlocks;
  for (int x = 0; x < kBlocks; ++x) {
    for (int y = 0; y < kBlocks; ++y) {
      const Range block{{slice.center[0] + (2 * x + 1 - kBlocks) * half_x,
                         slice.center[1] + (2 * y + 1 - kBlocks) * half_y, slice.center[2]},
                        {half_x, half_y, slice.half[2]},
                        slice.cosine,
                        slice.sine,
                        std::hypot(half_x, half_y)};
      bound_block(block, raster, x * kBlockParts, y * kBlockParts, bounds);
    }
  }
}

// Sums the tiles that may hold: those of all parts of the block once, the others for each of their parts.
void WeightedTiles::bound_block(const Range& block, const SliceRaster& raster, int first_x, int first_y,
                                PartBounds& bounds) const {
  Term everywhere;
  std::array<std::array<Term, kBlockParts>, kBlockParts> somewhere{};
  for (const Tile& t : raster.certain_tiles()) everywhere += term(block, grid_.center(t));
  for (const SliceRaster::Border& border : raster.border()) {
    std::array<std::uint32_t, kBlockParts> may{};
    std::uint32_t any = 0, all = kBlockBits;
    for (std::size_t y = 0; y < kBlockParts; ++y) {
      may[y] = border.may[static_cast<std::size_t>(first_y) + y] >> first_x & kBlockBits;
      any |= may[y];
      all &= may[y];
    }
    if (any == 0) continue;
    const Term one = term(block, grid_.center(border.tile));
    if (all == kBlockBits) {
      everywhere += one;
      continue;
    }
    for (std::size_t y = 0; y < kBlockParts; ++y) {
      for (std::size_t x = 0; x < kBlockParts; ++x) {
        if ((may[y] >> x & 1U) != 0) somewhere[x][y] += one;
      }
    }
  }
  const std::array<double, 3> half{block.half[0] / kBlockParts, block.half[1] / kBlockParts, block.half[2]};
  for (int x = 0; x < kBlockParts; ++x) {
    for (int y = 0; y < kBlockParts; ++y) {
      Term sum = everywhere;
      sum += somewhere[static_cast<std::size_t>(x)][static_cast<std::size_t>(y)];
      const double weight =
          sum.most({(2 * x + 1 - kBlockParts) * half[0], (2 * y + 1 - kBlockParts) * half[1], 0.0}, half);
      const double count = raster.certain() + raster.count(first_x + x, first_y + y);
      bounds[static_cast<std::size_t>(first_x + x)][static_cast<std::size_t>(first_y + y)] =
          std::min(weight, count * map_.most()) * (1.0 + kRounding);
    }
  }
}

int WeightedTiles::needed(double value) const {
  std::vector<double> falling = open_;
  std::ranges::sort(falling, std::greater<>());
  double sum = certain_ * (1.0 + kRounding);
  int n = 0;
  while (sum <= value && n < static_cast<int>(falling.size()))
    sum += falling[static_cast<std::size_t>(n++)] * (1.0 + kRounding);
  return n;
}

}  // namespace triskin::placement
