// SPDX-License-Identifier: GPL-3.0-or-later
#include "search/clearance.hpp"

#include <algorithm>
#include <array>

#include "search/branch_and_bound.hpp"
#include "search/clearance_ascent.hpp"

namespace triskin::placement {
namespace {

using Clock = std::chrono::steady_clock;
constexpr std::size_t kMaxStarts = 6;
constexpr double kStartsMayStandOver_mm = 1e-2;

// Returns the clearance plus the precision of the answer.
double more(double clearance) {
  return std::max(5e-3, 0.02 * std::abs(clearance));
}

}  // namespace

Clearance largest_clearance(const PreparedPolygon& polygon, const TileGrid& grid, const ClearanceGoal& goal,
                            const ProgressSink& progress) {
  ClearanceAscent ascent(polygon, grid, goal.modules);
  Clearance best;
  best.inset_mm = goal.min_inset_mm;
  best.bound_mm = goal.max_inset_mm;
  if (goal.known) {
    best.found = true;
    best.motion = *goal.known;
  }
  const auto next = [&] { return best.found ? best.inset_mm + more(best.inset_mm) : best.inset_mm; };
  const auto climb = [&](Motion at, double from) {
    const double reached = ascent.climb(at, from);
    if (reached < std::max(from, goal.min_inset_mm) || (best.found && reached <= best.inset_mm)) return;
    best.found = true;
    best.inset_mm = reached;
    best.motion = at;
  };
  for (const Motion& start : ascent.max_promising(goal.starts, kMaxStarts, goal.min_inset_mm - kStartsMayStandOver_mm))
    climb(start, goal.min_inset_mm);
  for (bool open = true; open && Clock::now() < goal.deadline;) {
    const SearchGoal search{.inset_mm = next(),
                            .tolerance_mm = 0.5 * more(best.inset_mm),
                            .known = goal.modules - 1,
                            .raise =
                                [&](const Motion& found) {
                                  climb(found, next() - 0.5 * more(best.inset_mm));
                                  return std::array{next(), 0.5 * more(best.inset_mm)};
                                },
                            .last_inset_mm = std::min(best.inset_mm + std::abs(best.inset_mm) + 0.1, goal.max_inset_mm),
                            .slices = goal.slices,
                            .threads = goal.threads,
                            .deadline = goal.deadline,
                            .memory_limit_bytes = goal.memory_limit_bytes};
    const SearchResult found = branch_and_bound(polygon, grid, search, progress);
    best.cells += found.cells;
    best.evaluations += found.evaluations;
    open =
        found.stopped == SearchStop::kNone && next() > search.last_inset_mm && search.last_inset_mm < goal.max_inset_mm;
    if (found.upper_bound < goal.modules) best.bound_mm = next();
  }
  return best;
}

}  // namespace triskin::placement
