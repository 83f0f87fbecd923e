// SPDX-License-Identifier: GPL-3.0-or-later
#include "cell_list.hpp"

#include <algorithm>

namespace triskin::geometry {
namespace {

constexpr std::size_t kNoBlock = static_cast<std::size_t>(-1);
constexpr double kSlack_mm = 1e-6;  // far above the rounding of distances

}  // namespace

bool CellFilter::center_inside(const CellFrame& f, const Vec2& center) const {
  const double x = center.x() - f.center[0], y = center.y() - f.center[1];
  return polygon_.contains({f.cosine * x + f.sine * y, -f.sine * x + f.cosine * y});
}

// What the inscribed and the circumscribed circle of the tile say about an edge.
CellFilter::Fate CellFilter::circles(const CellFrame& f, const OpenTile& tile, std::uint32_t edge, double& nearest) const {
  const std::size_t next = polygon_.next[edge];
  const double px = tile.center.x() - f.center[0] - f.x[edge], py = tile.center.y() - f.center[1] - f.y[edge];
  const double dx = f.x[next] - f.x[edge], dy = f.y[next] - f.y[edge];
  const double square = dx * dx + dy * dy;
  const double t = square > 0.0 ? std::clamp((px * dx + py * dy) / square, 0.0, 1.0) : 0.0;
  const double distance = std::sqrt((px - t * dx) * (px - t * dx) + (py - t * dy) * (py - t * dy));
  if (distance < grid_.inradius_mm + std::min(f.inset_mm, 0.0) - kSlack_mm - f.reach_mm) return Fate::kDead;
  if (distance > grid_.circumradius_mm + std::max(f.sufficient_mm, 0.0) + kSlack_mm + f.reach_mm) return Fate::kDecided;
  nearest = std::min(nearest, distance);
  return Fate::kOpen;
}

const PairBlock& CellFilter::block_of(const CellFrame& frame, const CellList& from, std::size_t pair) {
  const std::size_t number = pair / kLanes;
  if (number != block_number_) {
    const std::size_t first = number * kLanes;
    judge_pairs(polygon_, grid_, frame, from.tiles.data(), from.pairs.data() + first, std::min(kLanes, from.pairs.size() - first), block_);
    block_number_ = number;
  }
  return block_;
}

CellFilter::Fate CellFilter::judge_tile(const CellFrame& f, const CellList& from, OpenTile& tile, CellList& kept, Box& box, bool& free_at_center) {
  const std::size_t end = tile.first + tile.count, kept_first = kept.pairs.size();
  const auto kept_tile = static_cast<std::uint32_t>(kept.tiles.size());
  const double sure = f.sufficient_mm + f.pad_mm;
  double nearest = 1e300;
  for (std::size_t at = tile.first; at < end; ++at) {
    if (!tile.inside) {
      const Fate fate = circles(f, tile, from.pairs[at].edge, nearest);
      if (fate == Fate::kDead) return fate;
      if (fate == Fate::kDecided) continue;
    }
    const PairBlock& block = block_of(f, from, at);
    const std::size_t lane = at % kLanes;
    if (block.surest[lane] >= sure) continue;
    for (std::size_t k = 0; k < 3; ++k) {
      box.low[k] = std::max(box.low[k], block.low[k][lane]);
      box.high[k] = std::min(box.high[k], block.high[k][lane]);
      if (box.low[k] > box.high[k]) return Fate::kDead;
    }
    free_at_center = free_at_center && block.value[lane] >= f.sufficient_mm;
    kept.pairs.push_back({kept_tile, from.pairs[at].edge});
  }
  // Where no edge that can cut the tile passes its centre, inside and outside are the same in the whole cell.
  const bool decided = kept.pairs.size() == kept_first;
  if (!tile.inside && (decided || nearest > f.reach_mm + kSlack_mm)) {
    if (!center_inside(f, tile.center)) return Fate::kDead;
    tile.inside = true;
  }
  return decided ? Fate::kDecided : Fate::kOpen;
}

CellFilter::Outcome CellFilter::filter(const CellFrame& f, const CellList& from, int least, CellList& kept, OffsetBoxes& boxes) {
  kept.clear();
  boxes.clear();
  block_number_ = kNoBlock;
  Outcome outcome;
  int left = static_cast<int>(from.tiles.size());
  for (OpenTile tile : from.tiles) {
    Box box{{-f.half[0], -f.half[1], -f.half[2]}, {f.half[0], f.half[1], f.half[2]}};
    bool free_at_center = true;
    const std::size_t kept_first = kept.pairs.size();
    const Fate fate = judge_tile(f, from, tile, kept, box, free_at_center);
    if (fate == Fate::kOpen) {
      tile.first = static_cast<std::uint32_t>(kept_first);
      tile.count = static_cast<std::uint32_t>(kept.pairs.size() - kept_first);
      kept.tiles.push_back(tile);
      for (std::size_t k = 0; k < 3; ++k) {
        boxes.low[k].push_back(box.low[k]);
        boxes.high[k].push_back(box.high[k]);
      }
      if (free_at_center && (tile.inside || center_inside(f, tile.center))) ++outcome.free_at_center;
      continue;
    }
    kept.pairs.resize(kept_first);
    if (fate == Fate::kDecided) ++outcome.certain;
    else if (--left < least) return outcome;
  }
  outcome.alive = true;
  return outcome;
}

int CellFilter::seed(const CellFrame& f, CellList& to) {
  to.clear();
  const double span = f.reach_mm + grid_.circumradius_mm + std::max(0.0, f.inset_mm) + kSlack_mm;
  std::vector<std::pair<Tile, std::uint32_t>> near;
  Vec2 low = Vec2::Constant(1e300), high = -low;
  for (std::uint32_t k = 0; k < polygon_.x.size(); ++k) {
    const std::size_t next = polygon_.next[k];
    const Vec2 a(f.x[k] + f.center[0], f.y[k] + f.center[1]), b(f.x[next] + f.center[0], f.y[next] + f.center[1]);
    low = low.cwiseMin(a);
    high = high.cwiseMax(a);
    const Vec2 margin = Vec2::Constant(span);
    grid_.for_each_near(a.cwiseMin(b) - margin, a.cwiseMax(b) + margin, [&](const Tile& t) {
      double nearest = 1e300;
      if (circles(f, {grid_.center(t), t, false, 0, 0}, k, nearest) != Fate::kDecided) near.emplace_back(t, k);
    });
  }
  std::ranges::sort(near);
  for (std::size_t n = 0; n < near.size(); ++n) {
    if (n == 0 || near[n].first != near[n - 1].first) {
      to.tiles.push_back({grid_.center(near[n].first), near[n].first, false, static_cast<std::uint32_t>(to.pairs.size()), 0});
    }
    const auto tile = static_cast<std::uint32_t>(to.tiles.size() - 1);
    to.pairs.push_back({tile, near[n].second});
    ++to.tiles.back().count;
  }
  int certain = 0;
  const auto known = [&](const Tile& t) { return std::ranges::binary_search(to.tiles, t, {}, &OpenTile::tile); };
  grid_.for_each_near(low - Vec2::Constant(f.reach_mm), high + Vec2::Constant(f.reach_mm), [&](const Tile& t) {
    if (!known(t) && center_inside(f, grid_.center(t))) ++certain;
  });
  return certain;
}

}  // namespace triskin::geometry
