// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <algorithm>
#include <chrono>

#include "branch_and_bound.hpp"
#include "exact_recheck.hpp"
#include "heuristics.hpp"
#include "triskin/geometry/placement.hpp"
#include "triskin/geometry/polygon_io.hpp"
#include "triskin/host/error.hpp"

namespace triskin::geometry {
namespace {

using Clock = std::chrono::steady_clock;

Clock::time_point deadline_after(double seconds) {
  if (seconds <= 0.0) return Clock::time_point::max();
  return Clock::now() + std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(std::min(seconds, 1e8)));
}

void require_sane(const PlacementOptions& o) {
  if (!(o.tolerance_mm >= 1e-8 && o.tolerance_mm <= 1.0)) {
    throw InputError(fmt::format("tolerance {} mm: must be in 1e-8 … 1 (the rounding pad is 1e-9)", o.tolerance_mm));
  }
  if (!(o.gap_mm >= 0.0 && o.gap_mm <= 100.0)) throw InputError(fmt::format("gap {} mm: must be in 0 … 100", o.gap_mm));
}

// Of all placements of `modules` tiles the one with the largest inset, by bisection: each step asks the certified search
// whether that many tiles fit at a larger inset. Ends at 1 µm or 1 %.
void enlarge_clearance(const PreparedPolygon& polygon, const PlacementOptions& options, PlacementResult& result, Motion& motion,
                       Clock::time_point deadline, const ProgressSink& progress) {
  double low = -options.tolerance_mm, high = kInradius_mm;
  double step = 0.05;
  for (int k = 0; k < 40 && high - low > std::max(1e-3, 0.01 * low) && Clock::now() < deadline; ++k) {
    const double middle = high < kInradius_mm ? 0.5 * (low + high) : std::min(low + step, 0.5 * (low + high));
    step *= 2.0;
    SearchGoal goal{.inset_mm = middle, .pitch_mm = kSide_mm + options.gap_mm, .known = result.modules - 1, .stop_at_first = true,
                    .deadline = deadline};
    const SearchResult found = branch_and_bound(polygon, goal, progress);
    result.cells += found.cells;
    result.evaluations += found.evaluations;
    if (found.found) {
      low = middle;
      motion = found.motion;
    } else {
      high = middle;
    }
  }
  result.clearance_mm = low;
}

}  // namespace

std::vector<Tile> tiles_inside(const Polygon& polygon, const Placement& placement, double tolerance_mm, double gap_mm) {
  const PreparedPolygon p = prepare(polygon);
  const double c = std::cos(placement.theta_rad), s = std::sin(placement.theta_rad);
  const Vec2 o = p.first + p.center;
  const Motion motion{placement.x_mm + c * o.x() - s * o.y(), placement.y_mm + s * o.x() + c * o.y(), placement.theta_rad};
  return tiles_inside(p, motion, -tolerance_mm, kSide_mm + gap_mm);
}

PlacementResult place(const Polygon& input, const PlacementOptions& options, const ProgressSink& progress) {
  require_sane(options);
  const auto start = Clock::now();
  const auto deadline = deadline_after(options.time_limit_s);
  const PreparedPolygon polygon = prepare(normalize_polygon(input, "polygon"));
  const double pitch = kSide_mm + options.gap_mm;
  PlacementResult result;
  result.tolerance_mm = options.tolerance_mm;
  Motion motion;
  if (options.method == PlacementMethod::kBranchAndBound) {
    // A few descents give a value to beat: the search then opens only cells that promise more.
    PlacementOptions start_options = options;
    start_options.method = PlacementMethod::kR7;
    const HeuristicResult first = run_heuristic(polygon, start_options, 6);
    const SearchGoal goal{.inset_mm = -options.tolerance_mm, .pitch_mm = pitch, .known = first.modules, .deadline = deadline};
    const SearchResult found = branch_and_bound(polygon, goal, progress);
    result.modules = found.best;
    result.upper_bound = found.upper_bound;
    result.proved = found.best == found.upper_bound;
    result.cells = found.cells;
    result.evaluations = found.evaluations + first.evaluations;
    result.clearance_mm = -options.tolerance_mm;
    motion = found.found ? found.motion : first.motion;
    if (options.largest_clearance && result.modules > 0) enlarge_clearance(polygon, options, result, motion, deadline, progress);
  } else {
    const HeuristicResult found = run_heuristic(polygon, options);
    result.modules = found.modules;
    result.evaluations = found.evaluations;
    result.upper_bound = static_cast<int>(std::floor(polygon_area(input) / kModuleArea_mm2 * (1.0 + 1e-6) + 1e-3));
    result.proved = result.modules == result.upper_bound;
    result.clearance_mm = -options.tolerance_mm;
    motion = found.motion;
  }
  result.tiles = tiles_inside(polygon, motion, result.clearance_mm, pitch);
  result.placement = to_placement(polygon, motion);
  require_exact(polygon, motion, result.tiles, options.tolerance_mm, pitch);
  result.seconds = std::chrono::duration<double>(Clock::now() - start).count();
  return result;
}

}  // namespace triskin::geometry
