// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <algorithm>
#include <chrono>

#include "branch_and_bound.hpp"
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

// Makes the best of a motion that holds `modules` tiles: the inset at which they still fit, raised by axis steps.
class ClearanceAscent {
 public:
  ClearanceAscent(const PreparedPolygon& polygon, const TileGrid& grid, int modules)
      : polygon_(polygon), evaluator_(polygon, grid), inradius_(grid.inradius_mm), modules_(modules) {}

  /// The `n` motions with the largest clearance.
  std::vector<Motion> most_promising(std::vector<Motion> motions, std::size_t n) {
    std::vector<std::pair<double, std::size_t>> order;
    constexpr double least = -1e-2;
    for (std::size_t k = motions.size(); k-- > 0;) {
      if (holds(motions[k], least)) order.emplace_back(raise(motions[k], least), k);
    }
    std::ranges::sort(order, std::greater<>());
    std::vector<Motion> best;
    for (std::size_t k = 0; k < std::min(n, order.size()); ++k) best.push_back(motions[order[k].second]);
    return best;
  }

  double climb(Motion& motion, double clearance) {
    if (!holds(motion, clearance)) return -inradius_;
    clearance = raise(motion, clearance);
    for (double step = 1.0; step > 1e-4; step *= 0.5) {
      for (bool better = true; better;) {
        better = false;
        for (int k = 0; k < 18; ++k) {
          const Motion next = stepped(motion, step, k);
          if (!holds(next, clearance + 0.1 * step)) continue;
          motion = next;
          clearance = raise(motion, clearance + 0.1 * step);
          better = true;
        }
      }
    }
    return clearance;
  }

 private:
  bool holds(const Motion& m, double inset) { return evaluator_.count(m, inset) >= modules_; }

  // Largest inset at this motion, to 0.1 µm.
  double raise(const Motion& m, double low) {
    double high = inradius_;
    while (high - low > 1e-4) {
      const double middle = 0.5 * (low + high);
      (holds(m, middle) ? low : high) = middle;
    }
    return low;
  }

  // The six axis steps and the twelve diagonal ones.
  [[nodiscard]] Motion stepped(const Motion& m, double step, int k) const {
    static constexpr std::array<std::array<int, 3>, 9> kSteps{{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {1, 1, 0}, {1, -1, 0}, {1, 0, 1}, {1, 0, -1}, {0, 1, 1}, {0, 1, -1}}};
    const auto& s = kSteps[static_cast<std::size_t>(k / 2)];
    const double d = k % 2 == 0 ? step : -step;
    return {m.x + d * s[0], m.y + d * s[1], m.theta + d * s[2] / std::max(1.0, polygon_.radius_mm)};
  }

  const PreparedPolygon& polygon_;
  Evaluator evaluator_;
  double inradius_;
  int modules_;
};

// Of all placements of `modules` tiles one with the largest inset, to 5 µm or 2 %: climbs from the best of those that the
// search has seen, then asks the search for a better one; when there is none, that is the proof.
void enlarge_clearance(const PreparedPolygon& polygon, const TileGrid& grid, const PlacementOptions& options, std::vector<Motion> starts,
                       PlacementResult& result, Motion& motion, Clock::time_point deadline, const ProgressSink& progress) {
  ClearanceAscent ascent(polygon, grid, result.modules);
  double clearance = -options.tolerance_mm;
  starts.push_back(motion);
  for (const Motion& start : ascent.most_promising(std::move(starts), 3)) {
    Motion at = start;
    const double reached = ascent.climb(at, -options.tolerance_mm);
    if (reached > clearance) {
      clearance = reached;
      motion = at;
    }
  }
  result.clearance_bound_mm = grid.inradius_mm;
  const auto more = [&] { return std::max(5e-3, 0.02 * clearance); };
  for (bool open = true; open && Clock::now() < deadline;) {
    const SearchGoal goal{.inset_mm = clearance + more(), .tolerance_mm = 0.5 * more(), .known = result.modules - 1,
                          .raise = [&](const Motion& found) {
                            Motion at = found;
                            const double reached = ascent.climb(at, clearance + 0.5 * more());
                            if (reached > clearance) {
                              clearance = reached;
                              motion = at;
                            }
                            return std::array{clearance + more(), 0.5 * more()};
                          },
                          .last_inset_mm = std::min(2.0 * clearance + 0.1, grid.inradius_mm), .threads = options.threads, .deadline = deadline};
    const SearchResult found = branch_and_bound(polygon, grid, goal, progress);
    result.cells += found.cells;
    result.evaluations += found.evaluations;
    open = clearance + more() > goal.last_inset_mm;
    if (!open && found.upper_bound < result.modules) result.clearance_bound_mm = clearance + more();
  }
  result.clearance_mm = clearance;
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
    if (options.largest_clearance && result.modules > 0) {
      enlarge_clearance(polygon, grid, options, found.as_good, result, motion, deadline, progress);
    }
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
