// SPDX-License-Identifier: GPL-3.0-or-later
#include "search/objective_search.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <queue>
#include <tuple>

#include "kernels/contraction.hpp"
#include "kernels/edge_grid.hpp"
#include "kernels/evaluator.hpp"
#include "search/cell_parts.hpp"
#include "search/slices.hpp"

namespace triskin::placement {
namespace {

constexpr double kCell_bytes = sizeof(MotionBox) + 48.0;
constexpr double kResolution_mm = 1e-7;                     // Cells near the rounding pad are not halved any further.
constexpr int kMaxParts = 8;                                // A child has at most this many parts of its cell.
constexpr double kFirstStep_mm = 1.0, kLastStep_mm = 0.01;  // A climb begins and ends with these steps.

// Lists the certain and open tiles of a cell.
struct Known {
  std::vector<OpenTile> certain;
  CellList open;
  double reach_mm = 0.0;  // If positive, `open` has no edges yet, and those within this distance of a tile may cut it.
};

// What the raster found in a slice.
struct BoundedSlice {
  PartBounds bounds;
  std::vector<Tile> certain;
  std::vector<SliceRaster::Border> border;
};

struct ObjectiveCell {
  MotionBox box;
  double bound = 0.0;
  std::int64_t number = 0;                              // Among equals the last cell comes first.
  std::shared_ptr<const Known> known = nullptr;         // A slice has no list.
  std::shared_ptr<const BoundedSlice> slice = nullptr;  // Only a slice that is bounded has it.
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
        raster_(polygon, grid),
        edges_(polygon, grid.circumradius_mm + kSliceReach_mm) {}

  ObjectiveResult run(const Motion& first, double bound, const ObjectiveLimits& limits, const ProgressSink& progress) {
    result_.motion = first;
    result_.value = value_at(first);
    for (const MotionBox& box : slices_of(polygon_, grid_, 0.0)) push({.box = box, .bound = bound});
    while (!open_.empty() && open_.top().bound > closed_level()) {
      if (std::chrono::steady_clock::now() >= limits.deadline) result_.stopped = SearchStop::kTime;
      if (bytes_ + kCell_bytes * static_cast<double>(open_.size()) > limits.memory_bytes)
        result_.stopped = SearchStop::kMemory;
      if (result_.stopped != SearchStop::kNone) break;
      const ObjectiveCell cell = open_.top();
      open_.pop();
      bytes_ -= bytes_of(cell);
      report(progress, "placing", -1.0, fmt::format("value {:.4f}, bound {:.4f}", result_.value, cell.bound));
      expand(cell);
    }
    const double left = open_.empty() ? result_.value : std::max(result_.value, open_.top().bound);
    result_.bound = std::max({left, unresolved_, closed_bound_});
    result_.proved = result_.bound <= closed_level();
    if (too_large_ && !result_.proved && result_.stopped == SearchStop::kNone) result_.stopped = SearchStop::kMemory;
    return result_;
  }

 private:
  [[nodiscard]] double closed_level() const { return result_.value + objective_.slack(result_.value); }

  double value_at(const Motion& m) { return objective_.value(m, evaluator_.tiles(m, -tolerance_mm_)); }

  static double bytes_of(const ObjectiveCell& cell) {
    double bytes = 0.0;
    if (const BoundedSlice* const slice = cell.slice.get()) {
      bytes += static_cast<double>(sizeof(BoundedSlice) + slice->certain.capacity() * sizeof(Tile) +
                                   slice->border.capacity() * sizeof(SliceRaster::Border));
    }
    if (const Known* const known = cell.known.get()) {
      bytes += static_cast<double>(sizeof(Known) + known->open.pairs.capacity() * sizeof(Pair) +
                                   (known->certain.capacity() + known->open.tiles.capacity()) * sizeof(OpenTile));
    }
    return bytes;
  }

  void push(ObjectiveCell cell) {
    cell.number = ++pushed_;
    bytes_ += bytes_of(cell);
    open_.push(std::move(cell));
  }

  void set_frame(const MotionBox& box) {
    frame_.set(polygon_, grid_, box, 0.0, -tolerance_mm_);
    frame_.certain_mm = frame_.sufficient_mm;
  }

  void expand(const ObjectiveCell& cell) {
    ++result_.cells;
    if (!cell.known && !cell.slice) return bound_slice(cell);
    seek_start();
    if (cell.bound <= closed_level()) return close(cell.bound);
    cell.known ? refine(cell) : divide_slice(cell);
  }

  // Computes only the bounds: a better value found meanwhile closes many slices before they are divided.
  void bound_slice(const ObjectiveCell& cell) {
    set_frame(cell.box);
    if (raster_.bytes_for(frame_) > SliceRaster::kMaxBytes) {
      too_large_ = true;
      unresolved_ = std::max(unresolved_, cell.bound);
      return;
    }
    raster_.scan(frame_);
    raster_.collect(frame_);
    auto slice = std::make_shared<BoundedSlice>();
    slice->certain = raster_.certain_tiles();
    slice->border = raster_.border();
    objective_.bound_parts(frame_, raster_, slice->bounds);
    const PartIndex best = best_part(kSliceParts, [&](int x, int y) { return bound_of(slice->bounds, x, y); });
    const double bound = std::min(cell.bound, bound_of(slice->bounds, best[0], best[1]));
    const MotionBox part = part_box(cell.box, kSliceParts, best, {best[0] + 1, best[1] + 1, 1});
    promising_.emplace_back(bound, Motion{part.center(0), part.center(1), part.center(2)});
    push({.box = cell.box, .bound = bound, .slice = std::move(slice)});
  }

  [[nodiscard]] static double bound_of(const PartBounds& parts, int x, int y) {
    return parts[static_cast<std::size_t>(x)][static_cast<std::size_t>(y)];
  }

  // Seeks a value to beat, once, from the most promising motions and from the first one.
  void seek_start() {
    if (started_) return;
    started_ = true;
    std::ranges::stable_sort(promising_, std::greater{}, [](const auto& p) { return p.first; });
    promising_.resize(std::min(promising_.size(), kTriedSlices));
    for (const auto& [bound, motion] : promising_) try_motion(motion);
    climb(kFirstStep_mm);
  }

  void divide_slice(const ObjectiveCell& cell) {
    for (const auto& column : cell.slice->bounds) {
      for (const double bound : column) {
        if (bound <= closed_level()) close(bound);
      }
    }
    divide(
        cell, kSliceParts, [&](int x, int y, int) { return bound_of(cell.slice->bounds, x, y); },
        [&](const MotionBox& box, const PartIndex& low, const PartIndex& high) {
          return known_in_slice(*cell.slice, box, low, high);
        },
        {0, 0, 0}, kSliceParts);
  }

  // Makes children: small boxes around open parts, of which at least half are open. known_in() lists the tiles of a
  // box of parts.
  template <class BoundOf, class KnownIn>
  void divide(const ObjectiveCell& cell, const PartIndex& parts, const BoundOf& bound, const KnownIn& known_in,
              const PartIndex& low, const PartIndex& high) {
    const auto open = open_parts(low, high, bound, [this](double b) { return b > closed_level(); });
    if (open.count == 0) return;
    const MotionBox box = part_box(cell.box, parts, open.low, open.high);
    if (open.well_filled(kMaxParts)) {
      return push({.box = box,
                   .bound = std::min(cell.bound, open.most),
                   .known = std::make_shared<const Known>(known_in(box, open.low, open.high))});
    }
    const auto [first_high, second_low] =
        open.halves(longest_axis(half_extents_mm(box, polygon_.radius_mm), open.size()));
    divide(cell, parts, bound, known_in, second_low, open.high);
    divide(cell, parts, bound, known_in, open.low, first_high);
  }

  // Lists the tiles of some parts of a slice.
  [[nodiscard]] Known known_in_slice(const BoundedSlice& slice, const MotionBox& box, const PartIndex& low,
                                     const PartIndex& high) const {
    Known known;
    known.reach_mm = slice_child_reach_mm(polygon_, grid_, box, -tolerance_mm_);
    for (const Tile& t : slice.certain) known.certain.push_back({grid_.center(t), t, true, 0, 0});
    const auto wanted = static_cast<std::uint32_t>((1U << high[0]) - (1U << low[0]));
    for (const SliceRaster::Border& border : slice.border) {
      std::uint32_t any_may = 0, all_may = wanted, all_must = wanted;
      for (auto y = static_cast<std::size_t>(low[1]); y < static_cast<std::size_t>(high[1]); ++y) {
        any_may |= border.may[y] & wanted;
        all_may &= border.may[y];
        all_must &= border.must[y];
      }
      const OpenTile tile{grid_.center(border.tile), border.tile, all_may == wanted, 0, 0};
      if (all_must == wanted)
        known.certain.push_back(tile);
      else if (any_may != 0)
        known.open.tiles.push_back(tile);
    }
    return known;
  }

  void refine(const ObjectiveCell& cell) {
    const CellList* from = &cell.known->open;
    if (cell.known->reach_mm > 0.0) {
      list_with_edges(polygon_, edges_, cell.box, cell.known->reach_mm, *from, with_edges_);
      from = &with_edges_;
    }
    set_frame(cell.box);
    Known now;
    now.certain = cell.known->certain;
    (void)filter_.filter(frame_, *from, 0, now.open, boxes_, halves_, &now.certain);
    const double bound = std::min(cell.bound, objective_.bound(frame_, now.certain, now.open.tiles));
    if (objective_.most_at_middle() > result_.value &&
        try_motion({frame_.center[0], frame_.center[1], frame_.center[2]}))
      climb(std::hypot(frame_.half[0], frame_.half[1]));
    if (bound <= closed_level()) return close(bound);
    ObjectiveCell clipped{.box = cell.box, .bound = bound};
    if (contraction_.clip(clipped.box, boxes_, objective_.needed(result_.value))) look_ahead(clipped, now);
  }

  void look_ahead(const ObjectiveCell& cell, const Known& known) {
    if (std::ranges::max(half_extents_mm(cell.box, polygon_.radius_mm)) < kResolution_mm) {
      unresolved_ = std::max(unresolved_, cell.bound);
      return;
    }
    const PartsView view = parts_view(frame_, cell.box);
    lookahead_.run(view, halves_, words_);
    forget_certain_outside(known.open.tiles, words_);
    CubeBounds bounds;
    objective_.bound_cubes(view, words_, bounds);
    for (const double b : bounds) {
      if (b <= closed_level()) close(b);
    }
    divide(
        cell, kCubeParts,
        [&](int x, int y, int t) { return bounds[static_cast<std::size_t>(x + kPartsPerAxis * y + kLanesPerRow * t)]; },
        [&](const MotionBox&, const PartIndex& low, const PartIndex& high) { return known_in_cubes(known, low, high); },
        {0, 0, 0}, kCubeParts);
  }

  // Lists the tiles of some parts of the cell that was looked at last.
  [[nodiscard]] Known known_in_cubes(const Known& known, const PartIndex& low, const PartIndex& high) const {
    const PartWord wanted = wanted_parts(low, high);
    Known child;
    child.certain = known.certain;
    for (std::size_t t = 0; t < words_.size(); ++t) {
      std::uint32_t may = 0, may_fail = 0;
      for (std::size_t lane = 0; lane < kLanesPerRow; ++lane) {
        may |= words_[t][lane] & wanted[lane];
        may_fail |= wanted[lane] & ~(words_[t][lane] >> 16);
      }
      if (may_fail == 0)
        child.certain.push_back(known.open.tiles[t]);
      else if (may != 0)
        child.open.add(known.open, t);
    }
    return child;
  }

  bool try_motion(const Motion& motion) {
    const double value = value_at(motion);
    if (value <= result_.value) return false;
    result_.value = value;
    result_.motion = motion;
    return true;
  }

  // Slides and turns the best motion while that helps.
  void climb(double step_mm) {
    for (double step = step_mm; step > kLastStep_mm;) {
      const double before = result_.value;
      for (const double by : {step, -step}) {
        const Motion m = result_.motion;
        (void)(try_motion({m.x + by, m.y, m.theta}) || try_motion({m.x, m.y + by, m.theta}) ||
               try_motion({m.x, m.y, m.theta + by / polygon_.radius_mm}));
      }
      if (result_.value <= before) step *= 0.5;
    }
  }

  void close(double bound) { closed_bound_ = std::max(closed_bound_, bound); }

  static constexpr PartIndex kSliceParts{SliceRaster::kSteps, SliceRaster::kSteps, 1},
      kCubeParts{kPartsPerAxis, kPartsPerAxis, kPartsPerAxis};

  const PreparedPolygon& polygon_;
  const TileGrid& grid_;
  Objective& objective_;
  double tolerance_mm_;
  CellFilter filter_;
  Evaluator evaluator_;
  SliceRaster raster_;
  EdgeGrid edges_;
  Contraction contraction_;
  CellFrame frame_;
  CellList with_edges_;
  OffsetBoxes boxes_;
  std::vector<HalfSpace> halves_;
  Lookahead lookahead_;
  std::vector<PartWord> words_;
  std::priority_queue<ObjectiveCell> open_;
  // Each bounded slice has its bound and the middle of its best part.
  std::vector<std::pair<double, Motion>> promising_;
  std::int64_t pushed_ = 0;
  double bytes_ = 0.0;
  double unresolved_ = 0.0, closed_bound_ = 0.0;
  bool started_ = false, too_large_ = false;
  ObjectiveResult result_;
};

}  // namespace

ObjectiveResult search_objective(const PreparedPolygon& polygon, const TileGrid& grid, Objective& objective,
                                 double tolerance_mm, const Motion& first, double bound, const ObjectiveLimits& limits,
                                 const ProgressSink& progress) {
  return ObjectiveSearch(polygon, grid, objective, tolerance_mm).run(first, bound, limits, progress);
}

}  // namespace triskin::placement
