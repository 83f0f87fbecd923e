// SPDX-License-Identifier: GPL-3.0-or-later
#include "search/cell_list.hpp"

#include <algorithm>

namespace triskin::placement {
namespace {

constexpr std::size_t kNoBlock = static_cast<std::size_t>(-1);
constexpr double kSlack_mm = 1e-6;  // This is far above the rounding of distances.

}  // namespace

void CellList::add(const CellList& from, std::size_t number) {
  OpenTile tile = from.tiles[number];
  const std::uint32_t first_pair = tile.first;
  tile.first = static_cast<std::uint32_t>(pairs.size());
  for (std::uint32_t k = 0; k < tile.count; ++k)
    pairs.push_back({static_cast<std::uint32_t>(tiles.size()), from.pairs[first_pair + k].edge});
  tiles.push_back(tile);
}

PackedTiles::PackedTiles(const CellList& list) {
  tiles_.reserve(list.tiles.size());
  for (const OpenTile& t : list.tiles)
    tiles_.push_back({t.tile.i, 4 * t.tile.j + (t.tile.up ? 2 : 0) + (t.inside ? 1 : 0)});
}

std::shared_ptr<const CellList> PackedTiles::unpacked(const TileGrid& grid) const {
  auto list = std::make_shared<CellList>();
  list->tiles.reserve(tiles_.size());
  for (const PackedTile& t : tiles_) {
    const Tile tile{t.i, t.row >> 2, (t.row & 2) != 0};
    list->tiles.push_back({grid.center(tile), tile, (t.row & 1) != 0, 0, 0});
  }
  return list;
}

bool CellFilter::center_inside(const CellFrame& f, const Vec2& center) const {
  const double x = center.x() - f.center[0], y = center.y() - f.center[1];
  return polygon_.contains({f.cosine * x + f.sine * y, -f.sine * x + f.cosine * y});
}

const PairBlock& CellFilter::block_of(const CellFrame& frame, const CellList& from, std::size_t pair) {
  const std::size_t number = pair / kLanes;
  if (number != block_number_) {
    const std::size_t first = number * kLanes;
    evaluate_pairs(polygon_, grid_, frame, from.tiles.data(), from.pairs.data() + first,
                   std::min(kLanes, from.pairs.size() - first), block_);
    block_number_ = number;
  }
  return block_;
}

// Collects the possible directions of a pair with those of their constraints that may fail. A direction that cannot
// fail removes the restriction.
void CellFilter::collect(const CellFrame& f, double sign, std::uint32_t edge, std::size_t lane,
                         std::vector<HalfSpace>& halves) const {
  const std::size_t first = halves.size(), corners = static_cast<std::size_t>(grid_.corners);
  const double sure = f.certain_mm + f.pad_mm;
  for (std::size_t d = 0; d < 2 + corners; ++d) {
    if (!(block_.room[d][lane] >= 0.0)) continue;
    const bool line = d < 2;
    const double turn = d == 0 ? -1.0 : 1.0;  // Gives the sign of the normal, and for direction 1 of the values.
    const Vec2 gradient =
        line ? Vec2(turn * f.normal_x[edge], turn * f.normal_y[edge]) : Vec2(sign * grid_.normal[d - 2]);
    const double slide = std::abs(gradient.x()) * f.half[0] + std::abs(gradient.y()) * f.half[1];
    const std::size_t begin = line ? 0 : corners + 2 * (d - 2), end = line ? corners : begin + 2,
                      direction_first = halves.size();
    for (std::size_t c = begin; c < end; ++c) {
      const double flip = d == 1 ? -1.0 : 1.0;
      const double slope = flip * block_.slope[c][lane], value = flip * block_.level[c][lane];
      if (value >= slide + std::abs(slope) * f.half[2] + sure) continue;
      halves.push_back({value + f.pad_mm - f.inset_mm, gradient.x(), gradient.y(), slope, 0});
    }
    if (halves.size() == direction_first) {
      halves.resize(first);
      return;
    }
    halves.back().ends |= HalfSpace::kEndDirection;
  }
  if (halves.size() > first) halves.back().ends |= HalfSpace::kEndPair;
}

CellFilter::Fate CellFilter::evaluate_tile(const CellFrame& f, const CellList& from, OpenTile& tile, CellList& kept,
                                           Box& box, bool& free_at_center, std::vector<HalfSpace>& halves) {
  const std::size_t end = tile.first + tile.count, kept_first = kept.pairs.size();
  const auto kept_tile = static_cast<std::uint32_t>(kept.tiles.size());
  const double sure = f.certain_mm + f.pad_mm;
  // A tile that holds somewhere in the cell has its centre at least this far from every edge. If the centre moves less
  // than that against the polygon, a tile that is inside at the middle is inside wherever it holds.
  if (!tile.inside && f.reach_mm < grid_.inradius_mm + std::min(f.inset_mm, 0.0) - kSlack_mm) {
    if (!center_inside(f, tile.center)) return Fate::kDead;
    tile.inside = true;
  }
  for (std::size_t at = tile.first; at < end; ++at) {
    const PairBlock& block = block_of(f, from, at);
    const std::size_t lane = at % kLanes;
    if (block.surest[lane] >= sure) continue;
    for (std::size_t k = 0; k < 3; ++k) {
      box.low[k] = std::max(box.low[k], block.low[k][lane]);
      box.high[k] = std::min(box.high[k], block.high[k][lane]);
      if (box.low[k] > box.high[k]) return Fate::kDead;
    }
    free_at_center = free_at_center && block.value[lane] >= f.sufficient_mm;
    collect(f, tile.tile.up ? 1.0 : -1.0, from.pairs[at].edge, lane, halves);
    kept.pairs.push_back({kept_tile, from.pairs[at].edge});
  }
  const bool decided = kept.pairs.size() == kept_first;
  if (!tile.inside && decided && !center_inside(f, tile.center))
    return Fate::kDead;  // No edge comes near, so the tile is outside everywhere.
  return decided ? Fate::kDecided : Fate::kOpen;
}

CellFilter::Outcome CellFilter::filter(const CellFrame& f, const CellList& from, int least, CellList& kept,
                                       OffsetBoxes& boxes, std::vector<HalfSpace>& halves,
                                       std::vector<OpenTile>* certain) {
  kept.clear();
  boxes.clear();
  halves.clear();
  block_number_ = kNoBlock;
  Outcome outcome;
  int left = static_cast<int>(from.tiles.size());
  for (OpenTile tile : from.tiles) {
    Box box{{-f.half[0], -f.half[1], -f.half[2]}, {f.half[0], f.half[1], f.half[2]}};
    bool free_at_center = true;
    const std::size_t kept_first = kept.pairs.size(), halves_first = halves.size();
    const Fate fate = evaluate_tile(f, from, tile, kept, box, free_at_center, halves);
    if (fate == Fate::kOpen) {
      if (halves.size() == halves_first)
        halves.push_back({1.0, 0.0, 0.0, 0.0, HalfSpace::kEndDirection | HalfSpace::kEndPair});
      halves.back().ends |= HalfSpace::kEndTile;
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
    halves.resize(halves_first);
    if (fate == Fate::kDecided) {
      ++outcome.certain;
      if (certain != nullptr) certain->push_back(tile);
    } else if (--left < least) {
      return outcome;
    }
  }
  outcome.alive = true;
  return outcome;
}

}  // namespace triskin::placement
