// SPDX-License-Identifier: GPL-3.0-or-later
#include "search/conflict_bound.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <tuple>

#include "triskin/base/index.hpp"

namespace triskin::placement {
namespace {

constexpr double kFacing = 0.1;          // A side that faces an edge has a normal with at least this against it.
constexpr double kMinMultiplier = 0.05;  // Smaller multipliers of three constraints magnify rounding.
constexpr std::size_t kMaxRowsOfTile = 24;
constexpr std::size_t kMaxBetween = 12;  // Contested tiles are compared with the next 12 along their edges.
// A cell is promising if contradictions leave out one in so many of the tiles that must be left out.
constexpr int kPromising = 4;
constexpr int kMaxDrops = 3;            // Programs whose number grows as 4^drops are solved for at most this many.
constexpr std::ptrdiff_t kNearest = 4;  // A tile is compared with this many tiles to either side at an opposed edge.

Vec2 quarter_turn(const Vec2& v) {
  return {-v.y(), v.x()};
}
double cross(const Vec2& a, const Vec2& b) {
  return a.x() * b.y() - a.y() * b.x();
}

}  // namespace

ConflictBound::Verdict ConflictBound::judge(const CellFrame& frame, const CellList& list, int need) {
  dead_.assign(list.tiles.size(), 0);
  is_promising_ = true;
  if (static_cast<int>(list.tiles.size()) < need) return Verdict::kClosed;
  set_cell(frame, list);
  collect(frame, list);
  if (survivors(list, 0.0, need) >= need) {
    (void)survivors(list, 1.0, static_cast<int>(list.tiles.size()) + 1);
    return Verdict::kOpen;
  }
  return survivors(list, 1.0, need) >= need ? Verdict::kNarrower : Verdict::kClosed;
}

void ConflictBound::set_cell(const CellFrame& frame, const CellList& list) {
  pivot_ = Vec2::Zero();
  for (const OpenTile& tile : list.tiles) pivot_ += tile.center;
  pivot_ = pivot_ / static_cast<double>(std::max<std::size_t>(list.tiles.size(), 1)) -
           Vec2(frame.center[0], frame.center[1]);
  const double sine = std::sin(0.5 * frame.half[2]);
  sigma_ = std::sin(frame.half[2]) * (1.0 + 1e-12);
  curve_ = 2.0 * sine * sine * (1.0 + 1e-12);
  half_ = {frame.half[0], frame.half[1]};
  slide_ = std::hypot(frame.half[0], frame.half[1]) * (1.0 + 1e-12);
  shift_ = slide_ + pivot_.norm() * (sigma_ + curve_);
}

void ConflictBound::collect(const CellFrame& frame, const CellList& list) {
  rows_.clear();
  for (std::size_t first = 0; first < list.pairs.size(); first += kLanes) {
    const std::size_t count = std::min(kLanes, list.pairs.size() - first);
    evaluate_pairs(polygon_, grid_, frame, list.tiles.data(), list.pairs.data() + first, count, block_);
    for (std::size_t lane = 0; lane < count; ++lane) {
      const Pair& pair = list.pairs[first + lane];
      collect_pair(frame, list.tiles[pair.tile], pair, lane);
    }
  }
}

// Adds what a tile needs whichever of the possible directions separates it from the edge.
void ConflictBound::collect_pair(const CellFrame& frame, const OpenTile& tile, const Pair& pair, std::size_t lane) {
  const auto corners = static_cast<std::size_t>(grid_.corners);
  const bool left = block_.room[0][lane] >= 0.0, right = block_.room[1][lane] >= 0.0;
  const Vec2 normal(frame.normal_x[pair.edge], frame.normal_y[pair.edge]);
  std::size_t sides = 0, side = 0;
  double facing = 1.0;
  for (std::size_t k = 0; k < corners; ++k) {
    if (!(block_.room[2 + k][lane] >= 0.0)) continue;
    ++sides;
    side = k;
    facing = std::min(facing, (tile.tile.up ? -1.0 : 1.0) * grid_.normal[k].dot(normal) - frame.half[2]);
  }
  if (sides == 0 && left != right) {
    for (std::size_t k = 0; k < corners; ++k)
      add_line(frame, pair, left ? 1.0 : -1.0, tile.center + (tile.tile.up ? 1.0 : -1.0) * grid_.corner[k],
               frame.inset_mm);
    return;
  }
  if (sides == 1 && !left && !right) add_side(frame, tile, pair, side);
  if (sides > 0 && !right && facing > kFacing) {
    add_points_over_edge(frame, tile, pair, frame.inset_mm < 0.0 ? frame.inset_mm / facing : frame.inset_mm);
  }
}

// The edge lies beyond a side that faces it, or the tile lies left of its line. Either way a point of the tile whose
// foot is on the edge lies left of the line: with normal m, and the edge at least c beyond the side with normal n, by c
// / -(n.m), since n.(foot - point) >= c and foot - point = -(height of the point) m.
void ConflictBound::add_points_over_edge(const CellFrame& frame, const OpenTile& tile, const Pair& pair,
                                         double min_mm) {
  const std::size_t next = polygon_.next[pair.edge];
  const Vec2 centre(frame.center[0], frame.center[1]), start(frame.x[pair.edge], frame.y[pair.edge]),
      along(frame.normal_y[pair.edge], -frame.normal_x[pair.edge]);
  const double length = along.dot(Vec2(frame.x[next], frame.y[next]) - start);
  const double moved =
      slide_ + ((tile.center - centre).norm() + grid_.circumradius_mm) * frame.half[2] + 2.0 * polygon_.rounding_mm;
  const auto corners = static_cast<std::size_t>(grid_.corners);
  const double sign = tile.tile.up ? 1.0 : -1.0;
  for (std::size_t k = 0; k < corners; ++k) {
    const Vec2 a = tile.center + sign * grid_.corner[k], b = tile.center + sign * grid_.corner[(k + 1) % corners];
    const double foot_a = along.dot(a - centre - start), step = along.dot(b - a);
    double low = 0.0, high = 1.0;
    for (const auto& [from, rate] : {std::pair{foot_a - moved, step}, {length - moved - foot_a, -step}}) {
      if (rate > 1e-9)
        low = std::max(low, -from / rate);
      else if (rate < -1e-9)
        high = std::min(high, -from / rate);
      else if (from < 0.0)
        high = -1.0;
    }
    if (low > high) continue;
    add_line(frame, pair, 1.0, a + low * (b - a), min_mm);
    if (high < 1.0) add_line(frame, pair, 1.0, a + high * (b - a), min_mm);
  }
}

// Requires a point of the tile at least `min_mm` left (turn 1) or right (−1) of the edge's line.
void ConflictBound::add_line(const CellFrame& frame, const Pair& pair, double turn, const Vec2& point, double min_mm) {
  const Vec2 normal(turn * frame.normal_x[pair.edge], turn * frame.normal_y[pair.edge]),
      from(point.x() - frame.center[0], point.y() - frame.center[1]), arm = from - pivot_;
  keep({pair.tile, pair.edge, false, normal,
        normal.dot(from) - turn * polygon_.line_offset[pair.edge] - min_mm + polygon_.rounding_mm,
        -normal.dot(quarter_turn(arm)), std::max(0.0, -normal.dot(arm)) * curve_});
}

// Requires both ends of the edge beyond a side of the tile. The constraint is linear in the translation itself, which
// is w when all normals of a sum are of this kind and cancel; a sum of both kinds is not formed.
void ConflictBound::add_side(const CellFrame& frame, const OpenTile& tile, const Pair& pair, std::size_t side) {
  const Vec2 normal = (tile.tile.up ? 1.0 : -1.0) * grid_.normal[side],
             from(tile.center.x() - frame.center[0], tile.center.y() - frame.center[1]);
  for (const std::size_t end :
       {static_cast<std::size_t>(pair.edge), static_cast<std::size_t>(polygon_.next[pair.edge])}) {
    const Vec2 p(frame.x[end], frame.y[end]);
    keep({pair.tile, pair.edge, true, -normal,
          normal.dot(p - from) - grid_.offset_mm[side] - frame.inset_mm + polygon_.rounding_mm,
          normal.dot(quarter_turn(p - pivot_)), std::max(0.0, -normal.dot(p - pivot_)) * curve_});
  }
}

void ConflictBound::keep(const Row& row) {
  if (row.level < shift_ + std::abs(row.slope) * sigma_) rows_.push_back(row);
}

// Returns an upper bound of the tiles that can hold together by the constraints; stops below `need`.
int ConflictBound::survivors(const CellList& list, double softness, int need) {
  std::ranges::fill(dead_, 0);
  int alive = static_cast<int>(list.tiles.size());
  for (std::size_t first = 0, last = 0; first < rows_.size(); first = last) {
    while (last < rows_.size() && rows_[last].tile == rows_[first].tile) ++last;
    if (!holds_nowhere(first, last, softness)) continue;
    dead_[rows_[first].tile] = 1;
    if (--alive < need && softness == 0.0) return alive;
  }
  if (alive < need) return alive;
  find_conflicts(list, softness);
  const int pairs = matching(list.tiles.size()), bound = alive - pairs;
  if (bound < need || rows_.empty()) return bound;
  const int saved = saved_by_cliques(list, softness);
  const int all = static_cast<int>(list.tiles.size());
  is_promising_ = kPromising * (all - alive + std::max(pairs, saved)) > all - need;
  if (alive - saved < need) return need - 1;
  return contradict_each_other(softness, alive - need, pairs) ? need - 1 : bound;
}

// Of tiles that exclude each other pairwise, one at most holds. Divides the tiles that need two opposed edges into such
// cliques, and returns how many tiles the cliques, and the pairs of other tiles, leave out.
int ConflictBound::saved_by_cliques(const CellList& list, double softness) {
  find_contested(list);
  cliques_.clear();
  contested_at_.assign(dead_.size(), -1);
  for (std::size_t k = 0; k < contested_.size(); ++k) contested_at_[contested_[k].tile] = static_cast<std::int32_t>(k);
  for (std::size_t k = 0; k < contested_.size(); ++k) {
    const auto excludes_all = [&](const std::vector<std::size_t>& clique) {
      return std::ranges::all_of(clique, [&](std::size_t other) {
        return k - other <= kMaxBetween && exclude_jointly(contested_[other], contested_[k], softness);
      });
    };
    const auto clique = std::ranges::find_if(cliques_, excludes_all);
    if (clique != cliques_.end())
      clique->push_back(k);
    else
      cliques_.push_back({k});
  }
  int saved = static_cast<int>(contested_.size() - cliques_.size());
  for (std::uint32_t t = 0; t < mate_.size(); ++t) {
    if (mate_[t] > static_cast<std::int32_t>(t) && contested_at_[t] < 0 && contested_at_[at(mate_[t])] < 0) ++saved;
  }
  return saved;
}

// Lists the tiles with rows at two opposed edges in the order of their places along these edges.
void ConflictBound::find_contested(const CellList& list) {
  contested_.clear();
  for (std::uint32_t first = 0, last = 0; first < rows_.size(); first = last) {
    while (last < rows_.size() && rows_[last].tile == rows_[first].tile) ++last;
    if (dead_[rows_[first].tile] != 0) continue;
    const Row* opposed_row = nullptr;
    for (std::uint32_t k = first + 1; k < last && opposed_row == nullptr; ++k) {
      if (rows_[first].normal.dot(rows_[k].normal) <= kOpposed) opposed_row = &rows_[k];
    }
    if (opposed_row == nullptr) continue;
    Vec2 along = quarter_turn(opposed_row->normal);
    if (along.x() < 0.0) along = -along;
    contested_.push_back({rows_[first].tile, first, last, along.dot(list.tiles[rows_[first].tile].center)});
  }
  std::ranges::sort(contested_, {}, [](const Contested& c) { return std::pair(c.along, c.tile); });
}

bool ConflictBound::exclude_jointly(const Contested& a, const Contested& b, double softness) {
  program_.begin(dead_.size());
  for (std::uint32_t k = a.first; k < a.last; ++k) add_to_program(rows_[k], softness);
  for (std::uint32_t k = b.first; k < b.last; ++k) add_to_program(rows_[k], softness);
  for (const auto& [gradient, level] : box_rows(softness)) program_.add(JointProgram::kNoTile, gradient, level);
  return program_.contradictory(0);
}

void ConflictBound::add_to_program(const Row& row, double softness) {
  // The translation that a side sees is w turned by phi.
  const double level = row.level + softness * (row.soft + (row.by_side ? (sigma_ + curve_) * shift_ : 0.0));
  program_.add(row.tile, {-row.normal.x() * shift_, -row.normal.y() * shift_, row.slope * sigma_}, level);
}

// Tells whether fewer tiles hold together than `drops` less than all that are alive. With many more alive than needed,
// only the tiles that have no partner among the pairs are looked at.
bool ConflictBound::contradict_each_other(double softness, int drops, int pairs) {
  const bool without_pairs = drops > kMaxDrops;
  if (without_pairs) drops -= pairs;
  if (drops > kMaxDrops) return false;
  program_.begin(dead_.size());
  for (const Row& row : rows_) {
    if (dead_[row.tile] != 0 || (without_pairs && mate_[row.tile] >= 0)) continue;
    add_to_program(row, softness);
  }
  for (const auto& [gradient, level] : box_rows(softness)) program_.add(JointProgram::kNoTile, gradient, level);
  return program_.contradictory(drops);
}

// The box of the translations t - centre = w + sigma * J (w - pivot) - (1 - cos(phi)) (w - pivot), J a quarter turn.
std::array<ConflictBound::BoxRow, 4> ConflictBound::box_rows(double softness) const {
  const double soft = sigma_ * shift_ + curve_ * (shift_ + pivot_.norm());
  std::array<BoxRow, 4> rows;
  for (std::size_t k = 0; k < 4; ++k) {
    const double sign = k % 2 == 0 ? 1.0 : -1.0;
    const std::array<double, 3> gradient =
        k < 2 ? std::array{shift_, 0.0, pivot_.y() * sigma_} : std::array{0.0, shift_, -pivot_.x() * sigma_};
    rows[k] = {{sign * gradient[0], sign * gradient[1], sign * gradient[2]},
               half_[k / 2] + polygon_.rounding_mm + softness * soft};
  }
  return rows;
}

bool ConflictBound::holds_nowhere(std::size_t first, std::size_t last, double softness) {
  if (last - first < 2 || last - first > kMaxRowsOfTile) return false;
  excluded_.clear();
  add_pairs_of(first, last, softness);
  if (angles_covered()) return true;
  add_triples_of(first, last, softness);
  return angles_covered();
}

void ConflictBound::add_pairs_of(std::size_t first, std::size_t last, double softness) {
  for (std::size_t a = first; a < last; ++a) {
    for (std::size_t b = a + 1; b < last; ++b) {
      const Row &p = rows_[a], &q = rows_[b];
      if (!opposed(p, q)) continue;
      add_sum(p.level + q.level + softness * (p.soft + q.soft) + (p.normal + q.normal).norm() * shift_,
              p.slope + q.slope);
    }
  }
}

// Combines three constraints whose normals surround the origin.
void ConflictBound::add_triples_of(std::size_t first, std::size_t last, double softness) {
  for (std::size_t a = first; a < last; ++a) {
    for (std::size_t b = a + 1; b < last; ++b) {
      const Row &p = rows_[a], &q = rows_[b];
      const double r_part = cross(p.normal, q.normal);
      if (p.by_side != q.by_side || p.edge == q.edge || std::abs(r_part) < kMinMultiplier) continue;
      for (std::size_t c = b + 1; c < last; ++c) {
        const Row& r = rows_[c];
        const double p_part = cross(q.normal, r.normal) / r_part, q_part = cross(r.normal, p.normal) / r_part;
        if (r.by_side != p.by_side || r.edge == p.edge || r.edge == q.edge || p_part < kMinMultiplier ||
            q_part < kMinMultiplier)
          continue;
        const Vec2 rest = p_part * p.normal + q_part * q.normal + r.normal;
        add_sum(p_part * p.level + q_part * q.level + r.level +
                    softness * (p_part * p.soft + q_part * q.soft + r.soft) + rest.norm() * shift_,
                p_part * p.slope + q_part * q.slope + r.slope);
      }
    }
  }
}

// The constraints of the sum exclude each other if level + slope * sigma < 0.
void ConflictBound::add_sum(double level, double slope) {
  double low = -sigma_, high = sigma_;
  const double end = -level;  // At this value of slope * sigma the sum is 0.
  if (std::abs(slope) * sigma_ <= 1e-15) {
    if (level >= -1e-14) return;
  } else if (slope > 0.0) {
    high = std::min(high, end / slope - 1e-15);
  } else {
    low = std::max(low, end / slope + 1e-15);
  }
  if (low < high) excluded_.push_back({low, high});
}

bool ConflictBound::angles_covered() {
  std::ranges::sort(excluded_, {}, &Interval::low);
  double reached = -sigma_;
  for (const Interval& i : excluded_) {
    if (i.low > reached) return false;
    reached = std::max(reached, i.high);
  }
  return !excluded_.empty() && reached >= sigma_;
}

// Finds tiles that cannot hold together, at edges with opposed normals.
void ConflictBound::find_conflicts(const CellList& list, double softness) {
  conflicts_.resize(dead_.size());
  for (auto& of_tile : conflicts_) of_tile.clear();
  collect_needs(list, softness);
  std::ranges::sort(needs_, {}, [](const Needs& n) {
    return std::tuple(n.by_side, n.edge, n.normal.x(), n.normal.y(), n.along, n.tile);
  });
  std::vector<std::span<const Needs>> edges;
  for (std::size_t first = 0, last = 0; first < needs_.size(); first = last) {
    while (last < needs_.size() && needs_[last].at_same_edge(needs_[first])) ++last;
    edges.emplace_back(needs_.data() + first, last - first);
  }
  for (std::size_t m = 0; m < edges.size(); ++m) {
    for (std::size_t n = m + 1; n < edges.size(); ++n) {
      if (opposed(edges[m].front(), edges[n].front())) compare_edges(edges[m], edges[n], softness);
    }
  }
}

// Sorts the rows of the tiles that are alive by edge and normal.
void ConflictBound::collect_needs(const CellList& list, double softness) {
  needs_.clear();
  for (std::uint32_t k = 0; k < rows_.size(); ++k) {
    const Row& row = rows_[k];
    if (dead_[row.tile] != 0) continue;
    const double level = row.level + softness * row.soft;
    const bool continued = !needs_.empty() && needs_.back().last == k && needs_.back().tile == row.tile &&
                           needs_.back().by_side == row.by_side && needs_.back().edge == row.edge &&
                           needs_.back().normal == row.normal;
    if (!continued) {
      const double along = quarter_turn(row.normal).dot(list.tiles[row.tile].center);
      needs_.push_back({row.by_side, row.edge, row.normal, along, row.tile, k, k, level});
    }
    needs_.back().last = k + 1;
    needs_.back().least = std::min(needs_.back().least, level);
  }
}

// The sum over two tiles that are far apart along the edges changes fast with the angle and rarely excludes them, so a
// tile is compared with the nearest ones at the other edge only.
void ConflictBound::compare_edges(std::span<const Needs> at_one, std::span<const Needs> at_other, double softness) {
  for (const Needs& a : at_one) {
    const auto here = std::ranges::lower_bound(at_other, -a.along, {}, &Needs::along);
    const auto first = here - std::min<std::ptrdiff_t>(kNearest, here - at_other.begin()),
               last = here + std::min<std::ptrdiff_t>(kNearest, at_other.end() - here);
    for (auto b = first; b != last; ++b) {
      if (a.tile == b->tile || !exclude_each_other(a, *b, softness)) continue;
      conflicts_[a.tile].push_back(b->tile);
      conflicts_[b->tile].push_back(a.tile);
    }
  }
}

bool ConflictBound::exclude_each_other(const Needs& a, const Needs& b, double softness) {
  if (a.least + b.least >= 0.0) return false;  // They can hold together at the middle of the angles.
  const double rest = (a.normal + b.normal).norm() * shift_;
  excluded_.clear();
  for (std::size_t p = a.first; p < a.last; ++p) {
    for (std::size_t q = b.first; q < b.last; ++q) {
      add_sum(rows_[p].level + rows_[q].level + softness * (rows_[p].soft + rows_[q].soft) + rest,
              rows_[p].slope + rows_[q].slope);
    }
  }
  return angles_covered();
}

// Returns the number of disjoint pairs of tiles that exclude each other: each such pair holds one tile at most. It is
// the largest in the bipartite graph that remains after dropping conflicts inside a side.
int ConflictBound::matching(std::size_t tiles) {
  side_.assign(tiles, -1);
  mate_.assign(tiles, -1);
  std::vector<std::uint32_t> queue;
  for (std::uint32_t root = 0; root < tiles; ++root) {
    if (side_[root] >= 0 || conflicts_[root].empty()) continue;
    side_[root] = 0;
    queue.assign(1, root);
    for (std::size_t k = 0; k < queue.size(); ++k) {
      for (const std::uint32_t other : conflicts_[queue[k]]) {
        if (side_[other] >= 0) continue;
        side_[other] = 1 - side_[queue[k]];
        queue.push_back(other);
      }
    }
  }
  int pairs = 0;
  asked_for_.assign(tiles, 0);
  for (std::uint32_t t = 0; t < tiles; ++t) {
    if (side_[t] == 0 && augment(t, t + 1)) ++pairs;
  }
  return pairs;
}

bool ConflictBound::augment(std::uint32_t tile, std::uint32_t root) {
  for (const std::uint32_t other : conflicts_[tile]) {
    if (side_[other] != side_[tile] && mate_[other] < 0) return pair_up(tile, other);
  }
  for (const std::uint32_t other : conflicts_[tile]) {
    if (side_[other] == side_[tile] || asked_for_[other] == root) continue;
    asked_for_[other] = root;
    if (augment(static_cast<std::uint32_t>(mate_[other]), root)) return pair_up(tile, other);
  }
  return false;
}

bool ConflictBound::pair_up(std::uint32_t tile, std::uint32_t other) {
  mate_[other] = static_cast<std::int32_t>(tile);
  mate_[tile] = static_cast<std::int32_t>(other);
  return true;
}

}  // namespace triskin::placement
