// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <algorithm>
#include <chrono>

#include "kernels/connected_tiles.hpp"
#include "kernels/evaluator.hpp"
#include "kernels/exact_recheck.hpp"
#include "kernels/weighted_tiles.hpp"
#include "search/branch_and_bound.hpp"
#include "search/clearance.hpp"
#include "triskin/base/error.hpp"
#include "triskin/design/outline.hpp"
#include "triskin/placement/placement.hpp"
#include "triskin/placement/polygon_io.hpp"

namespace triskin::placement {
namespace {

using Clock = std::chrono::steady_clock;
constexpr double kMaxCellText_bytes = 150.0;  // A cell is six numbers of up to 24 characters.
// Where all modules of an exact fit hold within half the tolerance, the middle of a cell of this size, as a share of
// the tolerance, holds them within the tolerance, pads included.
constexpr double kResolution = 1.0 / 32.0;
constexpr double kMaxRadius_mm = 1e6;
constexpr double kMaxTiles = 1e6;
// Beyond this fraction of the inradius, the rest of a module is not worth the search.
constexpr double kMaxDeficit = 0.8;

Clock::time_point deadline_after(double seconds) {
  if (seconds <= 0.0) return Clock::time_point::max();
  return Clock::now() +
         std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(std::min(seconds, 1e8)));
}

bool is_of_paper(PlacementMethod m) {
  return m != PlacementMethod::kBranchAndBound;
}

void require_corner_cut(const PlacementOptions& o) {
  const double cut = o.corner_cut_mm;
  if (!(cut >= 0.0 && cut <= design::kMaxCornerCut_mm)) {
    throw InputError(fmt::format("corner cut {} mm: must be in 0 … {}; with more, taxels would lie in the cut part",
                                 cut, design::kMaxCornerCut_mm));
  }
  if (cut == 0.0) return;
  if (o.shape != TileShape::kTriangle) throw InputError("corner cut: only triangles have corners that are cut");
  if (is_of_paper(o.method))
    throw InputError(
        "corner cut: methods r1 … r7 are those of the reference paper, which knows a module by three whole sides; "
        "leave --corner-cut-mm out, or use --method bnb");
}

void require_sane(const PlacementOptions& o) {
  if (!(o.tolerance_mm >= 1e-8 && o.tolerance_mm <= 1.0)) {
    throw InputError(fmt::format("tolerance {} mm: must be in 1e-8 … 1 (the rounding pad is 1e-9)", o.tolerance_mm));
  }
  if ((o.connected || o.weights) && o.method != PlacementMethod::kBranchAndBound)
    throw InputError("connected modules and weights: only method bnb can do them");
  if (is_of_paper(o.method) && (o.shape != TileShape::kTriangle || o.gap_mm != 0.0))
    throw InputError("methods r1 … r7 place triangles without a gap; --method bnb takes other shapes and gaps");
  if (o.connected && o.weights) throw InputError("connected modules and weights: one aim at a time");
  if (!(o.memory_limit_mb >= 1.0))
    throw InputError(fmt::format("memory limit {} MB: must be at least 1", o.memory_limit_mb));
  if (!(o.proof_limit_mb >= 1.0 && o.proof_limit_mb <= 1e5))
    throw InputError(fmt::format("size of the proof {} MB: must be in 1 … 100000", o.proof_limit_mb));
  if ((o.connected || o.weights) && (o.keep_proof || o.proof_cell || o.deficit))
    throw InputError("connected modules and weights: there is no proof file and no deficit for them");
  const bool gap_in_range = o.gap_mm >= 0.0 && o.gap_mm <= 100.0;
  if (!gap_in_range) throw InputError(fmt::format("gap {} mm: must be in 0 … 100", o.gap_mm));
  require_corner_cut(o);
}

// Far from the centre or from the origin of the coordinates, doubles are too coarse for the tolerance.
void require_resolved(const PreparedPolygon& polygon, double tolerance_mm) {
  if (polygon.radius_mm > kMaxRadius_mm) {
    throw InputError(
        fmt::format("polygon: reaches {:.4g} m from its centre, more than 1 km; are the coordinates in mm?",
                    1e-3 * polygon.radius_mm));
  }
  const double offset_mm = (polygon.first + polygon.center).norm(), step_mm = 4.0 * 0x1p-52 * offset_mm;
  if (tolerance_mm < 10.0 * polygon.rounding_mm) {
    throw InputError(fmt::format(
        "tolerance {} mm: an outline that reaches {:.4g} m from its centre is known to {:.1e} mm only; give "
        "at least {:.1e} mm (--tolerance-mm)",
        tolerance_mm, 1e-3 * polygon.radius_mm, polygon.rounding_mm, 10.0 * polygon.rounding_mm));
  }
  if (tolerance_mm < step_mm) {
    throw InputError(fmt::format(
        "tolerance {} mm: {:.4g} m from the origin a placement is known to {:.1e} mm only; move the outline to "
        "the origin, or give at least as much tolerance (--tolerance-mm)",
        tolerance_mm, 1e-3 * offset_mm, step_mm));
  }
}

// Holds the state of one call of place().
struct Placing {
  const PreparedPolygon& polygon;
  const TileGrid& grid;
  const PlacementOptions& options;
  const ProgressSink& progress;
  Clock::time_point start, deadline;
  double area_mm2;
  PlacementResult result;
  Motion motion;
  std::vector<Motion> as_good;         // These motions seem to hold as many tiles.
  std::vector<MotionBox> tied_slices;  // Outside these slices fewer tiles hold.

  [[nodiscard]] double memory_limit_bytes() const { return 1e6 * options.memory_limit_mb; }

  [[nodiscard]] std::function<void(const ProofCell&)> proof_sink() {
    if (options.proof_cell || !options.keep_proof) return options.proof_cell;
    return [this](const ProofCell& cell) { result.proof.cells.push_back(cell); };
  }

  void certify_count() {
    const SearchGoal goal{.inset_mm = 0.0,
                          .tolerance_mm = options.tolerance_mm,
                          .resolution_mm = std::min(SearchGoal{}.resolution_mm, kResolution * options.tolerance_mm),
                          .known = 0,
                          .closed = proof_sink(),
                          .raise = {},
                          .threads = options.threads,
                          .deadline = deadline,
                          .memory_limit_bytes = memory_limit_bytes(),
                          .max_closed = static_cast<std::int64_t>(1e6 * options.proof_limit_mb / kMaxCellText_bytes)};
    SearchResult found = branch_and_bound(polygon, grid, goal, progress);
    result.modules = found.best;
    result.upper_bound = found.upper_bound;
    result.proved = found.best == found.upper_bound;
    result.stopped = found.stopped;
    result.cells = found.cells;
    result.evaluations = found.evaluations;
    motion = found.motion;
    tied_slices = std::move(found.tied_slices);
    as_good = std::move(found.as_good);
    as_good.push_back(motion);
    result.search_seconds = std::chrono::duration<double>(Clock::now() - start).count();
  }

  void refine() {
    std::vector<Motion> starts = as_good;
    if (options.largest_clearance && result.modules > 0) enlarge_clearance();
    if (options.deficit) find_deficit(std::move(starts));
  }

  [[nodiscard]] Clearance clearance_of(int modules, double min_mm, double max_mm, std::optional<Motion> known,
                                       std::vector<Motion> starts, const std::vector<MotionBox>* slices) {
    const Clearance c = largest_clearance(polygon, grid,
                                          {.modules = modules,
                                           .min_inset_mm = min_mm,
                                           .max_inset_mm = max_mm,
                                           .known = known,
                                           .starts = std::move(starts),
                                           .slices = slices,
                                           .threads = options.threads,
                                           .memory_limit_bytes = memory_limit_bytes(),
                                           .deadline = deadline},
                                          progress);
    result.cells += c.cells;
    result.evaluations += c.evaluations;
    return c;
  }

  // Finds the placement of `modules` tiles with the largest inset.
  void enlarge_clearance() {
    const Clearance c =
        clearance_of(result.modules, -options.tolerance_mm, grid.inradius_mm, motion, std::move(as_good), &tied_slices);
    result.clearance_bound_mm = c.bound_mm;
    if (!c.found) return;
    result.clearance_mm = c.inset_mm;
    motion = c.motion;
  }

  // Finds the deficit: the least distance by which all sides must be drawn in until one module more fits.
  void find_deficit(std::vector<Motion> starts) {
    const Clearance c = clearance_of(result.modules + 1, -kMaxDeficit * grid.inradius_mm, 0.0, std::nullopt,
                                     std::move(starts), nullptr);
    result.deficit_bound_mm = -c.bound_mm;
    if (!c.found) return;
    result.deficit_mm = -c.inset_mm;
    result.deficit_placement = to_placement(polygon, c.motion);
  }

  // The search for another objective begins at the placement of the most tiles and takes their number as a bound.
  void certify_objective() {
    std::unique_ptr<Objective> objective;
    if (options.weights)
      objective = std::make_unique<WeightedTiles>(polygon, grid, *options.weights);
    else
      objective = std::make_unique<ConnectedTiles>(grid);
    const double most = options.weights ? result.upper_bound * options.weights->most() : result.upper_bound;
    const ObjectiveResult found = search_objective(polygon, grid, *objective, options.tolerance_mm, motion, most,
                                                   {deadline, memory_limit_bytes()}, progress);
    if (found.stopped != SearchStop::kNone) result.stopped = found.stopped;
    motion = found.motion;
    result.cells += found.cells;
    result.proved = found.proved;
    if (options.weights) {
      result.weight = found.value;
      result.weight_bound = found.bound;
      result.modules = Evaluator(polygon, grid).count(motion, -options.tolerance_mm);
    } else {
      result.modules = static_cast<int>(found.value);
      result.upper_bound = static_cast<int>(found.bound);
    }
    result.search_seconds = std::chrono::duration<double>(Clock::now() - start).count();
  }

  // Computes B_u of the paper (Section IV-C), with room for rounding.
  void bound_by_area() {
    result.upper_bound = static_cast<int>(std::floor(area_mm2 / grid.area_mm2 * (1.0 + 1e-6) + 1e-3));
    result.proved = result.modules == result.upper_bound;
  }

  // Runs Algorithm 2 with one of R1 … R7. The touching distance is half the tolerance, so that an overhang by two
  // contacts passes the exact recheck.
  void by_paper(const Polygon& normalized) {
    const auto heuristic =
        static_cast<paper::Heuristic>(1 + static_cast<int>(options.method) - static_cast<int>(PlacementMethod::kR1));
    paper::HeuristicOptions chosen = options.paper;
    chosen.seed = options.seed;
    const paper::BestPlacement best =
        paper::algorithm2(normalized, std::span(&heuristic, 1), chosen,
                          {.touch_mm = 0.5 * options.tolerance_mm, .reject_pierced = true}, deadline);
    result.evaluations = best.evaluations;
    result.pivoted = best.placement;
    if (best.placement) motion = to_motion(polygon, paper::without_pivot(normalized, *best.placement));
    // A crack thinner than the tolerance through a node escapes the three sides; this removes such modules.
    std::ranges::set_intersection(best.patch, Evaluator(polygon, grid).tiles(motion, -options.tolerance_mm),
                                  std::back_inserter(result.tiles));
    result.modules = static_cast<int>(result.tiles.size());
    bound_by_area();
  }
};

}  // namespace

std::vector<Tile> tiles_inside(const Polygon& polygon, const Placement& placement, double tolerance_mm, double gap_mm,
                               double corner_cut_mm) {
  const PreparedPolygon p = prepare(polygon);
  const TileGrid grid = tile_grid(TileShape::kTriangle, gap_mm, corner_cut_mm);
  return Evaluator(p, grid).tiles(to_motion(p, placement), -tolerance_mm);
}

PlacementResult place(const Polygon& input, const PlacementOptions& options, const ProgressSink& progress) {
  require_sane(options);
  const auto start = Clock::now();
  const Polygon normalized = normalize_polygon(input, "polygon");
  const PreparedPolygon polygon = prepare(normalized);
  require_resolved(polygon, options.tolerance_mm);
  const TileGrid grid = tile_grid(options.shape, options.gap_mm, options.corner_cut_mm);
  if (polygon_area(input) > kMaxTiles * grid.area_mm2) {
    throw InputError(fmt::format("polygon: {:.4g} m² would take more than {:.0g} modules; are the coordinates in mm?",
                                 1e-6 * polygon_area(input), kMaxTiles));
  }
  Placing placing{polygon, grid, options, progress, start, deadline_after(options.time_limit_s), polygon_area(input),
                  {},      {},   {},      {}};
  PlacementResult& result = placing.result;
  result.tolerance_mm = options.tolerance_mm;
  result.clearance_mm = -options.tolerance_mm;
  if (options.method == PlacementMethod::kBranchAndBound) {
    placing.certify_count();
    if (options.connected || options.weights)
      placing.certify_objective();
    else
      placing.refine();
  } else {
    placing.by_paper(normalized);
  }
  if (!is_of_paper(options.method)) result.tiles = Evaluator(polygon, grid).tiles(placing.motion, result.clearance_mm);
  if (options.connected) result.tiles = largest_component(grid, result.tiles);
  if (options.weights) {
    WeightedTiles weighted(polygon, grid, *options.weights);
    for (const Tile& t : result.tiles) result.tile_weights.push_back(weighted.value(placing.motion, {t}));
  }
  result.modules_within_bound = Evaluator(polygon, grid).count(placing.motion, -0.5 * options.tolerance_mm);
  result.placement = to_placement(polygon, placing.motion);
  result.proof.shape = options.shape;
  result.proof.pivot = polygon.first + polygon.center;
  result.proof.pitch_mm = grid.row_step_mm;
  result.proof.corner_cut_mm = options.corner_cut_mm;
  result.proof.motion = {placing.motion.x, placing.motion.y, placing.motion.theta};
  require_exact(polygon, placing.motion, result.tiles, options.tolerance_mm, grid);
  result.seconds = std::chrono::duration<double>(Clock::now() - start).count();
  return result;
}

}  // namespace triskin::placement
