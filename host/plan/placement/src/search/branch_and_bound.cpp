// SPDX-License-Identifier: GPL-3.0-or-later
#include "search/branch_and_bound.hpp"

#include <fmt/format.h>
#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <array>
#include <map>

#include "kernels/evaluator.hpp"
#include "search/slices.hpp"

namespace triskin::placement {
namespace {

constexpr std::size_t kMaxAsGood = 64;
// Cells are refined in batches of a fixed size, so that the search does not depend on the threads.
constexpr std::size_t kBatch = 16;
constexpr double kLogged_s = 1.5e-6;  // Writing a cell to the log takes 0.7e-6 s (measured); we reserve twice that.
// After this many cells a search looks for constraints that contradict each other.
constexpr std::int64_t kLong = 200;

struct Descent {
  Motion motion;
  int modules;
  std::int64_t evaluations;
};

// Takes each of the six axis steps that leads to more modules, and halves the step.
Descent descend(Evaluator& evaluator, double radius_mm, double tolerance_mm, const Motion& start) {
  Descent best{start, evaluator.count(start, -tolerance_mm), 1};
  for (double step = 4.0; step > 0.05; step *= 0.5) {
    for (const auto& [dx, dy, dt] :
         {std::array{1., 0., 0.}, {-1., 0., 0.}, {0., 1., 0.}, {0., -1., 0.}, {0., 0., 1.}, {0., 0., -1.}}) {
      const Motion next{best.motion.x + step * dx, best.motion.y + step * dy,
                        best.motion.theta + step * dt / std::max(1.0, radius_mm)};
      const int modules = evaluator.count(next, -tolerance_mm);
      ++best.evaluations;
      if (modules > best.modules) best = {next, modules, best.evaluations};
    }
  }
  return best;
}

class BranchAndBound {
 public:
  BranchAndBound(const PreparedPolygon& polygon, const TileGrid& grid, const SearchGoal& goal,
                 const ProgressSink& progress)
      : polygon_(polygon),
        grid_(grid),
        goal_(goal),
        progress_(progress),
        demand_{goal.inset_mm, goal.tolerance_mm, goal.resolution_mm, goal.last_inset_mm,
                static_cast<bool>(goal.raise)},
        edges_(polygon,
               grid.circumradius_mm + std::max(0.0, std::max(goal.inset_mm, goal.last_inset_mm)) + kSliceReach_mm),
        expanders_([&] { return CellExpander(polygon, grid, edges_); }),
        arena_(goal.threads > 0 ? goal.threads : tbb::task_arena::automatic) {
    result_.best = goal.known;
  }

  SearchResult run() {
    add_roots();
    while (!open_.empty() && open_.begin()->first > result_.best) {
      result_.upper_bound = std::max(result_.best, open_.begin()->first);
      if (demand_.rising && demand_.inset_mm > demand_.last_inset_mm) break;
      // Some slices are bounded before a limit can be reached, so that there is a motion to return.
      if (result_.cells > 0 && limit_reached()) break;
      report(progress_, "placing", -1.0, fmt::format("{} modules, bound {}", result_.best, result_.upper_bound));
      if (bounded(next())) seek_start();
      demand_.conflicts = result_.cells >= kLong;
      take_batch();
      expand_batch();
      for (Expansion& e : expansions_) merge(e);
    }
    seek_start();
    for (const auto& [bound, cells] : open_) {
      for (const Cell& cell : cells) close(cell.box);
    }
    const int open_bound = open_.empty() ? 0 : open_.begin()->first;
    result_.upper_bound = std::max({result_.best, open_bound, unresolved_bound_});
    if (too_large_ && result_.stopped == SearchStop::kNone && result_.upper_bound > result_.best)
      result_.stopped = SearchStop::kMemory;
    for (const auto& [bound, box] : tied_slices_) {
      if (bound >= result_.best) result_.tied_slices.push_back(box);
    }
    for (const auto& [bound, cells] : open_) {
      for (const Cell& cell : cells) {
        if (cell.is_slice()) result_.tied_slices.push_back(cell.box);
      }
    }
    return std::move(result_);
  }

 private:
  void close(const MotionBox& box) {
    if (!goal_.closed) return;
    ++closed_;
    goal_.closed({box.low[0], box.high[0], box.low[1], box.high[1], box.low[2], box.high[2]});
  }

  // Open cells end as cells of the proof, and writing them takes time too.
  bool limit_reached() {
    const bool logged = static_cast<bool>(goal_.closed);
    const std::chrono::duration<double> log_time(logged ? kLogged_s * static_cast<double>(open_cells_) : 0.0);
    if (std::chrono::steady_clock::now() + std::chrono::duration_cast<std::chrono::steady_clock::duration>(log_time) >
        goal_.deadline)
      result_.stopped = SearchStop::kTime;
    else if (open_bytes_ > goal_.memory_limit_bytes)
      result_.stopped = SearchStop::kMemory;
    else if (logged && closed_ + open_cells_ > goal_.max_closed)
      result_.stopped = SearchStop::kProofSize;
    return result_.stopped != SearchStop::kNone;
  }

  // The list may be shared by two cells and is then counted twice.
  static double bytes_of(const Cell& cell) {
    if (cell.packed) return static_cast<double>(sizeof(Cell) + cell.packed->bytes());
    if (!cell.list) return sizeof(Cell);
    return static_cast<double>(sizeof(Cell) + sizeof(CellList) + cell.list->tiles.capacity() * sizeof(OpenTile) +
                               cell.list->pairs.capacity() * sizeof(Pair));
  }

  void push(Cell cell) {
    cell.bound = std::min(cell.bound, area_bound_);
    if (cell.bound > result_.best) {
      if (cell.list && open_bytes_ > goal_.unpacked_bytes) {
        cell.packed.emplace(*cell.list);
        cell.list.reset();
      }
      ++open_cells_;
      open_bytes_ += bytes_of(cell);
      return open_[cell.bound].push_back(std::move(cell));
    }
    if (cell.is_slice()) tied_slices_.emplace_back(cell.bound, cell.box);
    close(cell.box);
  }

  void add_roots() {
    double twice_area = 0.0;
    for (const auto& [a, b] : polygon_.edges) twice_area += a.x() * b.y() - a.y() * b.x();
    // A tile that may overhang still has everything that lies deeper inside.
    const double inset_mm = goal_.inset_mm - (goal_.raise ? 0.0 : 0.5 * goal_.tolerance_mm),
                 kept = kept_inradius(grid_, inset_mm);
    area_bound_ = static_cast<int>(std::floor(0.5 * twice_area / (kept * kept * grid_.area_mm2) * (1.0 + 1e-6) + 1e-3));
    const std::vector<MotionBox> slices =
        goal_.slices != nullptr ? *goal_.slices : slices_of(polygon_, grid_, inset_mm);
    for (const MotionBox& box : slices) push({.box = box, .certain = 0, .bound = area_bound_, .list = {}});
  }

  [[nodiscard]] const Cell& next() const { return open_.begin()->second.back(); }
  [[nodiscard]] static bool bounded(const Cell& cell) { return !cell.is_slice() || cell.promising; }

  // Takes the highest bounds, the last one first among equals. Slices without a bound come first and alone: the value
  // to beat is sought when all have one.
  void take_batch() {
    batch_.clear();
    const bool all_bounded = bounded(next());
    while (batch_.size() < kBatch && !open_.empty() && open_.begin()->first > result_.best &&
           bounded(next()) == all_bounded) {
      const auto bucket = open_.begin();
      --open_cells_;
      open_bytes_ -= bytes_of(bucket->second.back());
      Cell& cell = batch_.emplace_back(std::move(bucket->second.back()));
      if (cell.packed) {
        cell.list = cell.packed->unpacked(grid_);
        cell.packed.reset();
        cell.reach_mm =
            slice_child_reach_mm(polygon_, grid_, cell.box,
                                 demand_.rising ? demand_.last_inset_mm : demand_.inset_mm - demand_.tolerance_mm);
      }
      bucket->second.pop_back();
      if (bucket->second.empty()) open_.erase(bucket);
    }
    expansions_.assign(batch_.size(), {});
  }

  // Seeks a value to beat, once, by a descent from the best of the most promising motions. The search then opens only
  // cells that promise more.
  void seek_start() {
    if (demand_.rising || started_) return;
    started_ = true;
    Evaluator evaluator(polygon_, grid_);
    std::size_t tried = 0;
    for (const auto& [bound, cells] : open_) {
      for (auto cell = cells.rbegin(); cell != cells.rend() && tried < kTriedSlices; ++cell) {
        if (!cell->promising) continue;
        ++tried;
        take(evaluator.count(*cell->promising, goal_.inset_mm - goal_.tolerance_mm), *cell->promising);
      }
    }
    result_.evaluations += static_cast<std::int64_t>(tried);
    if (!result_.found) return;
    const Descent reached = descend(evaluator, polygon_.radius_mm, goal_.tolerance_mm, result_.motion);
    result_.evaluations += reached.evaluations;
    take(reached.modules, reached.motion);
  }

  void expand_batch() {
    const auto expand = [&](std::size_t k) {
      expanders_.local().expand(std::move(batch_[k]), demand_, result_.best, static_cast<bool>(goal_.closed),
                                expansions_[k]);
    };
    if (goal_.threads == 1) {
      for (std::size_t k = 0; k < batch_.size(); ++k) expand(k);
    } else {
      arena_.execute([&] { tbb::parallel_for(std::size_t{0}, batch_.size(), expand); });
    }
  }

  void merge(Expansion& e) {
    result_.cells += e.passes;
    result_.evaluations += e.passes;
    unresolved_bound_ = std::max(unresolved_bound_, e.unresolved_bound);
    too_large_ = too_large_ || e.too_large;
    for (const auto& [value, motion] : e.better) take(value, motion);
    for (const Motion& m : e.as_good) {
      if (e.best == result_.best && result_.as_good.size() < kMaxAsGood) result_.as_good.push_back(m);
    }
    tied_slices_.insert(tied_slices_.end(), e.tied_slices.begin(), e.tied_slices.end());
    for (const MotionBox& box : e.closed) close(box);
    for (Cell& cell : e.children) push(std::move(cell));
  }

  void take(int value, const Motion& motion) {
    if (value <= result_.best) return;
    result_.found = true;
    result_.motion = motion;
    if (goal_.raise) {
      const auto [inset, tolerance] = goal_.raise(motion);
      demand_.inset_mm = inset;
      demand_.tolerance_mm = tolerance;
      return;
    }
    result_.best = value;
    result_.as_good.clear();
  }

  const PreparedPolygon& polygon_;
  const TileGrid& grid_;
  const SearchGoal& goal_;
  const ProgressSink& progress_;
  Demand demand_;
  int area_bound_ = 0;
  bool started_ = false;
  int unresolved_bound_ = 0;
  bool too_large_ = false;
  std::int64_t closed_ = 0, open_cells_ = 0;
  double open_bytes_ = 0.0;
  SearchResult result_;
  std::vector<std::pair<int, MotionBox>> tied_slices_;
  std::map<int, std::vector<Cell>, std::greater<>> open_;
  std::vector<Cell> batch_;
  std::vector<Expansion> expansions_;
  EdgeGrid edges_;
  tbb::enumerable_thread_specific<CellExpander> expanders_;
  tbb::task_arena arena_;
};

}  // namespace

SearchResult branch_and_bound(const PreparedPolygon& polygon, const TileGrid& grid, const SearchGoal& goal,
                              const ProgressSink& progress) {
  return BranchAndBound(polygon, grid, goal, progress).run();
}

}  // namespace triskin::placement
