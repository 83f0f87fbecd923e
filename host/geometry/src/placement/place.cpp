// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <algorithm>
#include <chrono>

#include "branch_and_bound.hpp"
#include "clearance.hpp"
#include "evaluator.hpp"
#include "exact_recheck.hpp"
#include "heuristics.hpp"
#include "triskin/geometry/placement.hpp"
#include "triskin/geometry/polygon_io.hpp"
#include "triskin/host/error.hpp"

namespace triskin::geometry {
namespace {

using Clock = std::chrono::steady_clock;
constexpr double kMostTiles = 1e6;
constexpr double kMostDeficit = 0.8;  // of the inradius: what is left of a module beyond that is not worth the search

Clock::time_point deadline_after(double seconds) {
  if (seconds <= 0.0) return Clock::time_point::max();
  return Clock::now() + std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(std::min(seconds, 1e8)));
}

void require_sane(const PlacementOptions& o) {
  if (!(o.tolerance_mm >= 1e-8 && o.tolerance_mm <= 1.0)) {
    throw InputError(fmt::format("tolerance {} mm: must be in 1e-8 … 1 (the rounding pad is 1e-9)", o.tolerance_mm));
  }
  if (o.keep_proof && o.shape != TileShape::kTriangle) throw InputError("proof: there is one only for triangular modules");
  if (!(o.gap_mm >= 0.0 && o.gap_mm <= 100.0)) throw InputError(fmt::format("gap {} mm: must be in 0 … 100", o.gap_mm));
}

// Of all placements of `modules` tiles one with the largest inset.
void enlarge_clearance(const PreparedPolygon& polygon, const TileGrid& grid, const PlacementOptions& options, std::vector<Motion> starts,
                       PlacementResult& result, Motion& motion, Clock::time_point deadline, const ProgressSink& progress) {
  starts.push_back(motion);
  const Clearance c = largest_clearance(polygon, grid, {.modules = result.modules, .least_inset_mm = -options.tolerance_mm, .most_inset_mm = grid.inradius_mm,
                                                        .starts = std::move(starts), .threads = options.threads, .deadline = deadline}, progress);
  result.cells += c.cells;
  result.evaluations += c.evaluations;
  result.clearance_bound_mm = c.bound_mm;
  if (!c.found) return;
  result.clearance_mm = c.inset_mm;
  motion = c.motion;
}

// How far sides have to give way until one module more fits somewhere.
void find_deficit(const PreparedPolygon& polygon, const TileGrid& grid, const PlacementOptions& options, std::vector<Motion> starts,
                  PlacementResult& result, const Motion& motion, Clock::time_point deadline, const ProgressSink& progress) {
  starts.push_back(motion);
  const double least = -kMostDeficit * grid.inradius_mm;
  const Clearance c = largest_clearance(polygon, grid, {.modules = result.modules + 1, .least_inset_mm = least, .most_inset_mm = 0.0,
                                                        .starts = std::move(starts), .threads = options.threads, .deadline = deadline}, progress);
  result.cells += c.cells;
  result.evaluations += c.evaluations;
  result.deficit_bound_mm = -c.bound_mm;
  if (!c.found) return;
  result.deficit_mm = -c.inset_mm;
  result.deficit_placement = to_placement(polygon, c.motion);
}

}  // namespace

std::vector<Tile> tiles_inside(const Polygon& polygon, const Placement& placement, double tolerance_mm, double gap_mm) {
  const PreparedPolygon p = prepare(polygon);
  const double c = std::cos(placement.theta_rad), s = std::sin(placement.theta_rad);
  const Vec2 o = p.first + p.center;
  const Motion motion{placement.x_mm + c * o.x() - s * o.y(), placement.y_mm + s * o.x() + c * o.y(), placement.theta_rad};
  const TileGrid grid = tile_grid(TileShape::kTriangle, gap_mm);
  return Evaluator(p, grid).tiles(motion, -tolerance_mm);
}

PlacementResult place(const Polygon& input, const PlacementOptions& options, const ProgressSink& progress) {
  require_sane(options);
  const auto start = Clock::now();
  const auto deadline = deadline_after(options.time_limit_s);
  const PreparedPolygon polygon = prepare(normalize_polygon(input, "polygon"));
  const TileGrid grid = tile_grid(options.shape, options.gap_mm);
  if (polygon_area(input) > kMostTiles * grid.area_mm2) {
    throw InputError(fmt::format("polygon: {:.4g} m² would take more than {:.0g} modules; are the coordinates in mm?", 1e-6 * polygon_area(input), kMostTiles));
  }
  PlacementResult result;
  result.tolerance_mm = options.tolerance_mm;
  Motion motion;
  if (options.method == PlacementMethod::kBranchAndBound) {
    // A few descents give a value to beat: the search then opens only cells that promise more.
    PlacementOptions start_options = options;
    start_options.method = PlacementMethod::kR7;
    const HeuristicResult first = run_heuristic(polygon, grid, start_options, 6);
    const SearchGoal goal{.inset_mm = 0.0, .tolerance_mm = options.tolerance_mm, .known = first.modules,
                          .cells = options.keep_proof ? &result.proof.cells : nullptr, .raise = {}, .threads = options.threads, .deadline = deadline};
    const SearchResult found = branch_and_bound(polygon, grid, goal, progress);
    result.modules = found.best;
    result.upper_bound = found.upper_bound;
    result.proved = found.best == found.upper_bound;
    result.cells = found.cells;
    result.evaluations = found.evaluations + first.evaluations;
    result.clearance_mm = -options.tolerance_mm;
    motion = found.found ? found.motion : first.motion;
    result.search_seconds = std::chrono::duration<double>(Clock::now() - start).count();
    if (options.largest_clearance && result.modules > 0) enlarge_clearance(polygon, grid, options, found.as_good, result, motion, deadline, progress);
    if (options.deficit) find_deficit(polygon, grid, options, found.as_good, result, motion, deadline, progress);
  } else {
    const HeuristicResult found = run_heuristic(polygon, grid, options);
    result.modules = found.modules;
    result.evaluations = found.evaluations;
    result.upper_bound = static_cast<int>(std::floor(polygon_area(input) / grid.area_mm2 * (1.0 + 1e-6) + 1e-3));
    result.proved = result.modules == result.upper_bound;
    result.clearance_mm = -options.tolerance_mm;
    motion = found.motion;
  }
  result.tiles = Evaluator(polygon, grid).tiles(motion, result.clearance_mm);
  result.placement = to_placement(polygon, motion);
  result.proof.pivot = polygon.first + polygon.center;
  result.proof.pitch_mm = grid.row_step_mm;
  result.proof.motion = {motion.x, motion.y, motion.theta};
  require_exact(polygon, motion, result.tiles, options.tolerance_mm, grid);
  result.seconds = std::chrono::duration<double>(Clock::now() - start).count();
  return result;
}

}  // namespace triskin::geometry
