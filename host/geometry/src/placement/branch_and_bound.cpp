// SPDX-License-Identifier: GPL-3.0-or-later
#include "branch_and_bound.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <memory>

#include "cell_list.hpp"
#include "contraction.hpp"
#include "evaluator.hpp"

namespace triskin::geometry {
namespace {

constexpr std::size_t kMostAsGood = 64;

struct Cell {
  MotionBox box;
  int certain = 0;
  int undecided = 0;
  std::shared_ptr<const CellList> list;  // none: a root cell gets its tiles when it is looked at
  [[nodiscard]] int bound() const { return certain + undecided; }
};

class Search {
 public:
  Search(const PreparedPolygon& polygon, const TileGrid& grid, const SearchGoal& goal, const ProgressSink& progress)
      : polygon_(polygon), grid_(grid), goal_(goal), progress_(progress), filter_(polygon, grid), evaluator_(polygon, grid) {
    result_.best = goal.known;
  }

  SearchResult run() {
    add_roots();
    while (!open_.empty()) {
      auto bucket = open_.begin();
      result_.upper_bound = std::max(result_.best, std::min(bucket->first, area_bound_));
      if (bucket->first <= result_.best || (goal_.stop_at_first && result_.found)) break;
      if ((result_.cells & 63) == 0) {
        if (std::chrono::steady_clock::now() > goal_.deadline) break;
        report(progress_, "placing", -1.0, fmt::format("{} modules, bound {}", result_.best, result_.upper_bound));
      }
      Cell cell = std::move(bucket->second.back());
      bucket->second.pop_back();
      if (bucket->second.empty()) open_.erase(bucket);
      expand(cell);
    }
    for (const auto& [bound, cells] : open_) {
      for (const Cell& cell : cells) close(cell.box);
    }
    const int open_bound = open_.empty() ? 0 : std::min(open_.begin()->first, area_bound_);
    result_.upper_bound = std::max({result_.best, open_bound, unresolved_bound_});
    return result_;
  }

 private:
  // A cell that the search is done with: part of the proof.
  void close(const MotionBox& box) {
    if (goal_.cells == nullptr) return;
    goal_.cells->push_back({box.low[0], box.high[0], box.low[1], box.high[1], box.low[2], box.high[2]});
  }

  // The slabs that a contraction cut off.
  void close_clipped(MotionBox whole, const MotionBox& clipped) {
    if (goal_.cells == nullptr) return;
    for (std::size_t k = 0; k < 3; ++k) {
      MotionBox slab = whole;
      slab.high[k] = clipped.low[k];
      if (slab.low[k] < slab.high[k]) close(slab);
      slab = whole;
      slab.low[k] = clipped.high[k];
      if (slab.low[k] < slab.high[k]) close(slab);
      whole.low[k] = clipped.low[k];
      whole.high[k] = clipped.high[k];
    }
  }

  void push(Cell cell) {
    const int bound = cell.list ? cell.bound() : area_bound_;
    if (bound > result_.best) open_[bound].push_back(std::move(cell));
    else close(cell.box);
  }

  void add_roots() {
    double twice_area = 0.0;
    for (const auto& [a, b] : polygon_.edges) twice_area += a.x() * b.y() - a.y() * b.x();
    area_bound_ = static_cast<int>(std::floor(0.5 * twice_area / grid_.area_mm2 * (1.0 + 1e-6) + 1e-3));
    // Angles over which the farthest vertex moves by about half a module: short lists from the start.
    const double period = grid_.period_rad * (1.0 + 1e-12);
    const int n = std::clamp(static_cast<int>(std::ceil(period * polygon_.radius_mm / 24.0)), 1, 4096);
    for (int k = n - 1; k >= 0; --k) {
      Cell cell;
      cell.box.high = {grid_.row_step_mm, grid_.row_height_mm * (1.0 + 1e-12), period * (k + 1) / n};
      cell.box.low[2] = period * k / n;
      push(std::move(cell));
    }
  }

  void note_value(int value) {
    ++result_.evaluations;
    const Motion motion{frame_.center[0], frame_.center[1], frame_.center[2]};
    if (value == result_.best && result_.as_good.size() < kMostAsGood) result_.as_good.push_back(motion);
    if (value <= result_.best) return;
    // Count again at the very motion that is returned; the filtered lists are only a shortcut.
    const int counted = evaluator_.count(motion, goal_.inset_mm - goal_.tolerance_mm);
    if (counted <= result_.best) return;
    result_.best = counted;
    result_.motion = motion;
    result_.found = true;
    result_.as_good.clear();
  }

  void expand(Cell& cell) {
    set_frame(cell.box);
    CellList* from = &lists_[0];
    CellList* to = &lists_[1];
    const CellList* source = cell.list.get();
    if (source == nullptr) {
      cell.certain = filter_.seed(frame_, *from);
      source = from;
    }
    for (int pass = 0; pass < 8; ++pass) {
      ++result_.cells;
      if (pass > 0) set_frame(cell.box);
      const CellFilter::Outcome found = filter_.filter(frame_, *source, result_.best + 1 - cell.certain, *to, boxes_);
      if (!found.alive) return close(cell.box);
      cell.certain += found.certain;
      cell.undecided = static_cast<int>(to->tiles.size());
      note_value(cell.certain + found.free_at_center);
      if (cell.bound() <= result_.best) return close(cell.box);
      const double before = size(cell.box);
      const MotionBox whole = cell.box;
      if (!contraction_.clip(cell.box, boxes_, result_.best + 1 - cell.certain)) return close(whole);
      close_clipped(whole, cell.box);
      source = to;
      std::swap(from, to);
      if (size(cell.box) > 0.7 * before) break;
    }
    cell.list = std::make_shared<const CellList>(*source);
    split(cell);
  }

  void set_frame(const MotionBox& box) { frame_.set(polygon_, grid_, box, goal_.inset_mm, goal_.inset_mm - goal_.tolerance_mm); }
  [[nodiscard]] double size(const MotionBox& box) const { return std::max({box.half(0), box.half(1), polygon_.radius_mm * box.half(2)}); }

  void split(Cell& cell) {
    const std::array<double, 3> weighted{cell.box.half(0), cell.box.half(1), polygon_.radius_mm * cell.box.half(2)};
    const auto axis = static_cast<std::size_t>(std::ranges::max_element(weighted) - weighted.begin());
    if (weighted[axis] < goal_.resolution_mm) {  // near the rounding pad: stays open in the bound
      unresolved_bound_ = std::max(unresolved_bound_, cell.bound());
      return close(cell.box);
    }
    Cell other = cell;
    cell.box.high[axis] = other.box.low[axis] = cell.box.center(axis);
    push(std::move(other));
    push(std::move(cell));
  }

  const PreparedPolygon& polygon_;
  const TileGrid& grid_;
  const SearchGoal goal_;
  const ProgressSink& progress_;
  int area_bound_ = 0;
  int unresolved_bound_ = 0;
  SearchResult result_;
  std::map<int, std::vector<Cell>, std::greater<>> open_;  // by bound; last in, first out inside
  CellFilter filter_;
  Evaluator evaluator_;
  CellFrame frame_;
  std::array<CellList, 2> lists_;
  OffsetBoxes boxes_;
  Contraction contraction_;
};

}  // namespace

SearchResult branch_and_bound(const PreparedPolygon& polygon, const TileGrid& grid, const SearchGoal& goal, const ProgressSink& progress) {
  return Search(polygon, grid, goal, progress).run();
}

}  // namespace triskin::geometry
