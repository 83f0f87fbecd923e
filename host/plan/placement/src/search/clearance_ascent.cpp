// SPDX-License-Identifier: GPL-3.0-or-later
#include "search/clearance_ascent.hpp"

#include <algorithm>
#include <tuple>

namespace triskin::placement {
namespace {

constexpr double kFirstRadius_mm = 1.0, kLargestRadius_mm = 4.0, kMinRadius_mm = 1e-5;
constexpr double kMinGain_mm = 1e-5;
constexpr int kMaxSteps = 60;
constexpr double kApart_mm = 0.05;  // Motions that are closer climb to the same place.

}  // namespace

// Edges that are farther away than this from a tile's centre cannot bind, neither now nor after a step.
ClearanceAscent::ClearanceAscent(const PreparedPolygon& polygon, const TileGrid& grid, int modules)
    : polygon_(polygon),
      grid_(grid),
      evaluator_(polygon, grid),
      edges_(polygon, grid.circumradius_mm + grid.inradius_mm + 3.0 * kLargestRadius_mm),
      modules_(static_cast<std::size_t>(modules)) {}

std::vector<Motion> ClearanceAscent::max_promising(const std::vector<Motion>& motions, std::size_t n, double min_mm) {
  std::vector<std::pair<double, std::size_t>> order;
  for (std::size_t k = motions.size(); k-- > 0;) {
    const double separation = choose_tiles(motions[k], min_mm);
    if (separation >= min_mm) order.emplace_back(separation, k);
  }
  std::ranges::sort(order, std::greater<>());
  std::vector<Motion> best;
  for (const auto& [separation, k] : order) {
    const Motion& m = motions[k];
    const bool close = std::ranges::any_of(best, [&](const Motion& b) {
      return std::hypot(m.x - b.x, m.y - b.y) + polygon_.radius_mm * std::abs(m.theta - b.theta) < kApart_mm;
    });
    if (!close) best.push_back(m);
    if (best.size() == n) break;
  }
  return best;
}

// Chooses the tiles that hold with the inset; if there are more than needed, those with the most room. Returns the
// least separation.
double ClearanceAscent::choose_tiles(const Motion& motion, double inset_mm) {
  const std::vector<Tile> found = evaluator_.tiles(motion, inset_mm);
  if (found.size() < modules_) return -grid_.inradius_mm;
  tiles_.clear();
  for (const Tile& t : found) tiles_.push_back({grid_.center(t), t, true, 0, 0});
  double least = min_separation(motion, false);
  if (found.size() == modules_) return least;
  std::vector<std::size_t> order(tiles_.size());
  for (std::size_t k = 0; k < order.size(); ++k) order[k] = k;
  std::ranges::sort(order, [&](std::size_t a, std::size_t b) {
    return std::pair(-separation_[a], a) < std::pair(-separation_[b], b);
  });
  std::vector<OpenTile> kept;
  for (std::size_t k = 0; k < modules_; ++k) kept.push_back(tiles_[order[k]]);
  tiles_ = std::move(kept);
  return separation_[order[modules_ - 1]];
}

void ClearanceAscent::list_pairs(const Motion& motion) {
  pairs_.clear();
  const double c = std::cos(motion.theta), s = std::sin(motion.theta);
  for (std::uint32_t t = 0; t < tiles_.size(); ++t) {
    const Vec2 p = tiles_[t].center - Vec2(motion.x, motion.y);
    for (const std::uint32_t edge : edges_.near({c * p.x() + s * p.y(), -s * p.x() + c * p.y()}))
      pairs_.push_back({t, edge});
  }
}

double ClearanceAscent::min_separation(const Motion& motion, bool collect) {
  list_pairs(motion);
  const std::array<double, 3> at{motion.x, motion.y, motion.theta};
  frame_.set(polygon_, grid_, {at, at}, 0.0, 0.0);
  separation_.assign(tiles_.size(), grid_.inradius_mm);
  if (collect) program_.rows.clear();
  double least = grid_.inradius_mm;
  for (std::size_t first = 0; first < pairs_.size(); first += kLanes) {
    const std::size_t count = std::min(kLanes, pairs_.size() - first);
    evaluate_pairs(polygon_, grid_, frame_, tiles_.data(), pairs_.data() + first, count, block_);
    for (std::size_t lane = 0; lane < count; ++lane) {
      double& of_tile = separation_[pairs_[first + lane].tile];
      of_tile = std::min(of_tile, block_.value[lane]);
      least = std::min(least, block_.value[lane]);
      if (collect) collect_rows(first + lane, lane);
    }
  }
  return least;
}

// Collects the constraints of the direction with the most room: inset − gradient·move ≤ level.
void ClearanceAscent::collect_rows(std::size_t pair, std::size_t lane) {
  if (block_.value[lane] > grid_.inradius_mm + 3.0 * kLargestRadius_mm) return;
  const auto corners = static_cast<std::size_t>(grid_.corners);
  const std::uint32_t edge = pairs_[pair].edge;
  const double sign = tiles_[pairs_[pair].tile].tile.up ? 1.0 : -1.0;
  for (std::size_t d = 0; d < 2 + corners; ++d) {
    const std::size_t begin = d < 2 ? 0 : corners + 2 * (d - 2), end = d < 2 ? corners : begin + 2;
    const double flip = d == 1 ? -1.0 : 1.0;
    double least = 1e300;
    for (std::size_t c = begin; c < end; ++c) least = std::min(least, flip * block_.level[c][lane]);
    if (least < block_.value[lane]) continue;
    const Vec2 gradient =
        d < 2 ? Vec2(-flip * Vec2(frame_.normal_x[edge], frame_.normal_y[edge])) : Vec2(sign * grid_.normal[d - 2]);
    for (std::size_t c = begin; c < end; ++c) {
      // The angle is measured by the path of the farthest vertex.
      program_.rows.push_back(
          {{-gradient.x(), -gradient.y(), -flip * block_.slope[c][lane] / std::max(1.0, polygon_.radius_mm), 1.0},
           flip * block_.level[c][lane]});
    }
    return;
  }
}

bool ClearanceAscent::step(double radius_mm, std::array<double, 4>& move) {
  auto& rows = program_.rows;
  std::ranges::sort(rows, [](const LinearRow<4>& a, const LinearRow<4>& b) {
    return std::tie(a.limit, a.weight) < std::tie(b.limit, b.weight);
  });
  const double r = radius_mm, high = grid_.inradius_mm;
  // A row that lies behind the first one by more than the step can change never binds.
  const double limit = rows.empty() ? high : rows.front().limit + 6.0 * r + 1.0;
  while (!rows.empty() && rows.back().limit > limit) rows.pop_back();
  return maximize<4>({0.0, 0.0, 0.0, 1.0}, {-r, -r, -r, -high - 4.0 * r - 10.0}, {r, r, r, high}, program_, move);
}

double ClearanceAscent::climb(Motion& motion, double inset_mm) {
  const double start = choose_tiles(motion, inset_mm);
  if (start < inset_mm - 1e-6) return -grid_.inradius_mm;
  double reached = start, radius = kFirstRadius_mm;
  for (int k = 0; k < kMaxSteps && radius > kMinRadius_mm; ++k) {
    min_separation(motion, true);
    std::array<double, 4> move{};
    if (!step(radius, move) || move[3] < reached + kMinGain_mm) break;
    const Motion next{motion.x + move[0], motion.y + move[1],
                      motion.theta + move[2] / std::max(1.0, polygon_.radius_mm)};
    const double there = min_separation(next, false), gain = there - reached, promised = move[3] - reached;
    if (gain > 0.1 * promised) {
      motion = next;
      reached = there;
      if (gain > 0.75 * promised) radius = std::min(2.0 * radius, kLargestRadius_mm);
    } else {
      radius *= 0.25;
    }
  }
  return counted(motion, reached, inset_mm);
}

// Returns the largest inset that Evaluator confirms, because its count is the definition.
double ClearanceAscent::counted(const Motion& motion, double reached, double least) {
  const auto holds = [&](double inset) { return evaluator_.count(motion, inset) >= static_cast<int>(modules_); };
  for (const double inset : {reached, reached - 1e-9, reached - 1e-6}) {
    if (holds(inset)) return inset;
  }
  if (!holds(least)) return -grid_.inradius_mm;
  for (double high = reached; high - least > 1e-4;) {
    const double middle = 0.5 * (least + high);
    (holds(middle) ? least : high) = middle;
  }
  return least;
}

}  // namespace triskin::placement
