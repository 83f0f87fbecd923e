// SPDX-License-Identifier: GPL-3.0-or-later
#include "search/objective_search.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <queue>
#include <tuple>

#include "kernels/contraction.hpp"
#include "kernels/edge_grid.hpp"
#include "triskin/placement/kernels/evaluator.hpp"

namespace triskin::geometry {
namespace {

constexpr double kRoot_mm = 8.0;  // A root cell has this extent along each axis.
constexpr double kCell_bytes = sizeof(MotionBox) + 48.0;
constexpr double kResolution_mm = 1e-7;  // Cells near the rounding pad are not halved any further.

// Lists the certain and open tiles of a cell. Its halves share the list and filter it again.
struct Known {
  std::vector<OpenTile> certain;
  CellList open;
};

struct ObjectiveCell {
  MotionBox box;
  double bound = 0.0;
  std::int64_t number = 0;             // Among equals the last cell comes first.
  std::shared_ptr<const Known> known;  // A root has no list.
  bool operator<(const ObjectiveCell& other) const {
    return std::tie(bound, number) < std::tie(other.bound, other.number);
  }
};

class ObjectiveSearch {
 public:
  ObjectiveSearch(const PreparedPolygon& polygon, const TileGrid& grid, Objective& objective, double tolerance_mm)
      : polygon_(polygon),
        grid_(grid),
        objective_(objective),
        tolerance_mm_(tolerance_mm),
        filter_(polygon, grid),
        evaluator_(polygon, grid),
        edges_(polygon, 2.0 * grid.circumradius_mm + 2.0 * kRoot_mm) {}

  ObjectiveResult run(const Motion& first, double bound, const ObjectiveLimits& limits, const ProgressSink& progress) {
    result_.motion = first;
    result_.value = value_at(first);
    add_roots(bound);
    while (!open_.empty() && open_.top().bound > closed_level()) {
      if (std::chrono::steady_clock::now() >= limits.deadline) result_.stopped = SearchStop::kTime;
      if (bytes_ + kCell_bytes * static_cast<double>(open_.size()) > limits.memory_bytes)
        result_.stopped = SearchStop::kMemory;
      if (result_.stopped != SearchStop::kNone) break;
      const ObjectiveCell cell = open_.top();
      open_.pop();
      bytes_ -= 0.5 * bytes_of(cell.known);
      report(progress, "placing", -1.0, fmt::format("value {:.4f}, bound {:.4f}", result_.value, cell.bound));
      expand(cell);
    }
    const double left = open_.empty() ? result_.value : std::max(result_.value, open_.top().bound);
    result_.bound = std::max({left, unresolved_, closed_bound_});
    result_.proved = result_.bound <= closed_level();
    return result_;
  }

 private:
  [[nodiscard]] double closed_level() const { return result_.value + objective_.slack(result_.value); }

  double value_at(const Motion& m) { return objective_.value(m, evaluator_.tiles(m, -tolerance_mm_)); }

  void add_roots(double bound) {
    const std::array<double, 3> extent{grid_.row_step_mm, grid_.row_height_mm * (1.0 + 1e-12),
                                       grid_.period_rad * (1.0 + 1e-12)};
    const std::array<double, 3> lever{1.0, 1.0, polygon_.radius_mm};
    std::array<int, 3> pieces{};
    for (std::size_t k = 0; k < 3; ++k)
      pieces[k] = std::clamp(static_cast<int>(std::ceil(extent[k] * lever[k] / kRoot_mm)), 1, 1 << 14);
    const auto at = [&](std::size_t axis, int k) { return extent[axis] * k / pieces[axis]; };
    for (int t = 0; t < pieces[2]; ++t) {
      for (int y = 0; y < pieces[1]; ++y) {
        for (int x = 0; x < pieces[0]; ++x)
          push({{at(0, x), at(1, y), at(2, t)}, {at(0, x + 1), at(1, y + 1), at(2, t + 1)}}, bound, nullptr);
      }
    }
  }

  // Both halves of a cell share the list.
  static double bytes_of(const std::shared_ptr<const Known>& known) {
    if (!known) return 0.0;
    return static_cast<double>(sizeof(Known) + known->open.pairs.capacity() * sizeof(Pair) +
                               (known->certain.capacity() + known->open.tiles.capacity()) * sizeof(OpenTile));
  }

  void push(const MotionBox& box, double bound, std::shared_ptr<const Known> known) {
    bytes_ += 0.5 * bytes_of(known);
    open_.push({box, bound, ++pushed_, std::move(known)});
  }

  // Returns all tiles near the polygon, with the edges that can come near them in the cell.
  [[nodiscard]] std::shared_ptr<const Known> root(const MotionBox& box) const {
    auto known = std::make_shared<Known>();
    const double c = std::cos(box.center(2)), s = std::sin(box.center(2)),
                 reach = polygon_.radius_mm + 2.0 * kRoot_mm + grid_.circumradius_mm;
    const int last_row = static_cast<int>(std::ceil((box.center(1) + reach) / grid_.row_height_mm));
    for (int j = static_cast<int>(std::floor((box.center(1) - reach) / grid_.row_height_mm)) - 1; j <= last_row; ++j) {
      const double shift = grid_.row_shift_mm * j;
      const int last = static_cast<int>(std::ceil((box.center(0) + reach - shift) / grid_.row_step_mm));
      for (int i = static_cast<int>(std::floor((box.center(0) - reach - shift) / grid_.row_step_mm)) - 1; i <= last;
           ++i) {
        for (int up = 2 - grid_.kinds; up < 2; ++up) add_tile({i, j, up != 0}, box, c, s, *known);
      }
    }
    return known;
  }

  void add_tile(const Tile& tile, const MotionBox& box, double c, double s, Known& known) const {
    const Vec2 center = grid_.center(tile), p = center - Vec2(box.center(0), box.center(1));
    const Vec2 q(c * p.x() + s * p.y(), -s * p.x() + c * p.y());
    const auto near = edges_.near(q);
    if (near.empty()) {  // No edge comes near this tile.
      if (polygon_.contains(q)) known.certain.push_back({center, tile, true, 0, 0});
      return;
    }
    const auto number = static_cast<std::uint32_t>(known.open.tiles.size());
    known.open.tiles.push_back({center, tile, false, static_cast<std::uint32_t>(known.open.pairs.size()),
                                static_cast<std::uint32_t>(near.size())});
    for (const std::uint32_t edge : near) known.open.pairs.push_back({number, edge});
  }

  void expand(const ObjectiveCell& cell) {
    ++result_.cells;
    const std::shared_ptr<const Known> from = cell.known ? cell.known : root(cell.box);
    frame_.set(polygon_, grid_, cell.box, 0.0, -tolerance_mm_);
    frame_.certain_mm = frame_.sufficient_mm;
    auto now = std::make_shared<Known>();
    now->certain = from->certain;
    (void)filter_.filter(frame_, from->open, 0, now->open, boxes_, halves_, &now->certain);
    const double bound = std::min(cell.bound, objective_.bound(frame_, now->certain, now->open.tiles));
    const Motion middle{frame_.center[0], frame_.center[1], frame_.center[2]};
    if (bound > closed_level()) try_motion(middle);
    if (bound <= closed_level()) return close(bound);
    MotionBox box = cell.box;
    if (!contraction_.clip(box, boxes_, objective_.needed(result_.value))) return;
    halve(box, bound, std::move(now));
  }

  void try_motion(const Motion& motion) {
    const double value = value_at(motion);
    if (value <= result_.value) return;
    result_.value = value;
    result_.motion = motion;
  }

  void close(double bound) { closed_bound_ = std::max(closed_bound_, bound); }

  void halve(const MotionBox& box, double bound, std::shared_ptr<const Known> known) {
    const std::array<double, 3> size{box.half(0), box.half(1), polygon_.radius_mm * box.half(2)};
    const auto axis = static_cast<std::size_t>(std::ranges::max_element(size) - size.begin());
    if (size[axis] < kResolution_mm) {
      unresolved_ = std::max(unresolved_, bound);
      return;
    }
    MotionBox low = box, high = box;
    low.high[axis] = high.low[axis] = box.center(axis);
    push(low, bound, known);
    push(high, bound, std::move(known));
  }

  const PreparedPolygon& polygon_;
  const TileGrid& grid_;
  Objective& objective_;
  double tolerance_mm_;
  CellFilter filter_;
  Evaluator evaluator_;
  EdgeGrid edges_;
  Contraction contraction_;
  CellFrame frame_;
  OffsetBoxes boxes_;
  std::vector<HalfSpace> halves_;
  std::priority_queue<ObjectiveCell> open_;
  std::int64_t pushed_ = 0;
  double bytes_ = 0.0;
  double unresolved_ = 0.0, closed_bound_ = 0.0;
  ObjectiveResult result_;
};

}  // namespace

ObjectiveResult search_objective(const PreparedPolygon& polygon, const TileGrid& grid, Objective& objective,
                                 double tolerance_mm, const Motion& first, double bound, const ObjectiveLimits& limits,
                                 const ProgressSink& progress) {
  return ObjectiveSearch(polygon, grid, objective, tolerance_mm).run(first, bound, limits, progress);
}

}  // namespace triskin::geometry
