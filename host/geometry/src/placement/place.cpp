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

// Makes the best of a motion that holds `modules` tiles: the inset at which they still fit, raised by axis steps.
class ClearanceAscent {
 public:
  ClearanceAscent(const PreparedPolygon& polygon, double pitch_mm, int modules) : polygon_(polygon), pitch_(pitch_mm), modules_(modules) {}

  double climb(Motion& motion, double clearance) {
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
  [[nodiscard]] bool holds(const Motion& m, double inset) const { return count_inside(polygon_, m, inset, pitch_) >= modules_; }

  // Largest inset at this motion, to 0.1 µm.
  [[nodiscard]] double raise(const Motion& m, double low) const {
    double high = kInradius_mm;
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
  double pitch_;
  int modules_;
};

// Of all placements of `modules` tiles one with the largest inset, to 1 µm or 1 %: climbs, then asks the certified search for
// a placement that is better; when there is none, that is the proof.
void enlarge_clearance(const PreparedPolygon& polygon, const PlacementOptions& options, PlacementResult& result, Motion& motion,
                       Clock::time_point deadline, const ProgressSink& progress) {
  const double pitch = kSide_mm + options.gap_mm;
  ClearanceAscent ascent(polygon, pitch, result.modules);
  double clearance = ascent.climb(motion, -options.tolerance_mm);
  while (Clock::now() < deadline) {
    const double more = std::max(1e-3, 0.01 * clearance);
    const SearchGoal goal{.inset_mm = clearance + more, .tolerance_mm = 0.5 * more, .pitch_mm = pitch, .known = result.modules - 1,
                          .stop_at_first = true, .deadline = deadline};
    const SearchResult found = branch_and_bound(polygon, goal, progress);
    result.cells += found.cells;
    result.evaluations += found.evaluations;
    if (!found.found) break;
    motion = found.motion;
    clearance = ascent.climb(motion, clearance + 0.5 * more);
  }
  result.clearance_mm = clearance;
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
    const SearchGoal goal{.inset_mm = 0.0, .tolerance_mm = options.tolerance_mm, .pitch_mm = pitch, .known = first.modules,
                          .cells = options.keep_proof ? &result.proof.cells : nullptr, .deadline = deadline};
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
  result.proof.pivot = polygon.first + polygon.center;
  result.proof.pitch_mm = pitch;
  result.proof.motion = {motion.x, motion.y, motion.theta};
  require_exact(polygon, motion, result.tiles, options.tolerance_mm, pitch);
  result.seconds = std::chrono::duration<double>(Clock::now() - start).count();
  return result;
}

}  // namespace triskin::geometry
