// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernels/weighted_tiles.hpp"

#include <algorithm>
#include <cmath>

namespace triskin::geometry {
namespace {

constexpr double kRounding = 1e-12;  // This bounds the relative rounding of sums of some thousand terms.

double spread(const std::array<double, 3>& slope, const std::array<double, 3>& half) {
  return std::abs(slope[0]) * half[0] + std::abs(slope[1]) * half[1] + std::abs(slope[2]) * half[2];
}

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

// The centre of a tile, seen from the polygon, is q = Rᵀ(c − t): ∂q/∂t = −Rᵀ, ∂q/∂θ = (q_y, −q_x).
// It moves by at most `far` in the cell; the first order omits `bend` of that.
WeightedTiles::Term WeightedTiles::term(const CellFrame& f, const Vec2& center) const {
  const Vec2 p = center - Vec2(f.center[0], f.center[1]);
  const Vec2 q(f.cosine * p.x() + f.sine * p.y(), -f.sine * p.x() + f.cosine * p.y());
  const WeightMap::Jet jet = map_.at(q + polygon_.first + polygon_.center);
  const Vec2 turned(f.cosine * jet.slope_per_mm.x() - f.sine * jet.slope_per_mm.y(),
                    f.sine * jet.slope_per_mm.x() + f.cosine * jet.slope_per_mm.y());
  const double slide = std::hypot(f.half[0], f.half[1]), lever = q.norm();
  const double far = slide + lever * f.half[2], bend = (0.5 * lever * f.half[2] + slide) * f.half[2];
  return {jet.value,
          {-turned.x(), -turned.y(), jet.slope_per_mm.x() * q.y() - jet.slope_per_mm.y() * q.x()},
          map_.max_slope_per_mm() * bend + 0.5 * map_.max_curvature_per_mm2() * far * far};
}

double WeightedTiles::bound(const CellFrame& f, const std::vector<OpenTile>& certain,
                            const std::vector<OpenTile>& open) {
  Term sum{0.0, {}, 0.0};
  double each = 0.0;
  for (const OpenTile& t : certain) {
    const Term one = term(f, t.center);
    sum.value += one.value;
    sum.rest += one.rest;
    for (std::size_t k = 0; k < 3; ++k) sum.slope[k] += one.slope[k];
    each += std::min(map_.most(), one.value + spread(one.slope, f.half) + one.rest);
  }
  certain_ = std::min(each, sum.value + spread(sum.slope, f.half) + sum.rest);
  open_.clear();
  double total = certain_;
  for (const OpenTile& t : open) {
    const Term one = term(f, t.center);
    open_.push_back(std::clamp(one.value + spread(one.slope, f.half) + one.rest, 0.0, map_.most()));
    total += open_.back();
  }
  return total * (1.0 + kRounding);
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

}  // namespace triskin::geometry
