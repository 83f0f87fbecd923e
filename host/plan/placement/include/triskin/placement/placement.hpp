// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "triskin/base/names.hpp"
#include "triskin/base/progress.hpp"
#include "triskin/design/design_types.hpp"
#include "triskin/placement/paper/heuristics.hpp"
#include "triskin/placement/weight_map.hpp"

namespace triskin::placement {

enum class PlacementMethod {
  kBranchAndBound,  ///< Branch and bound proves its answer.
  // These are the heuristics of the reference paper (paper/heuristics.hpp); they need triangles without gap.
  kR1,
  kR2,
  kR3,
  kR4,
  kR5,
  kR6,
  kR7
};
/// All shapes have sides of 30 mm.
enum class TileShape { kTriangle, kHexagon, kSquare };
/// Options and proof files use these names: "triangle", "square", "hexagon".
inline constexpr NameTable kTileShapeNames{std::array<std::pair<TileShape, std::string_view>, 3>{
    {{TileShape::kTriangle, "triangle"}, {TileShape::kSquare, "square"}, {TileShape::kHexagon, "hexagon"}}}};

/// Tells which limit ended a search before value and bound met.
enum class SearchStop { kNone, kTime, kMemory, kProofSize };
/// JSON output uses these names: "none", "time", "memory", "proof size".
inline constexpr NameTable kSearchStopNames{
    std::array<std::pair<SearchStop, std::string_view>, 4>{{{SearchStop::kNone, "none"},
                                                            {SearchStop::kTime, "time"},
                                                            {SearchStop::kMemory, "memory"},
                                                            {SearchStop::kProofSize, "proof size"}}}};

/// A box of motions in a proof: x0, x1, y0, y1 in mm, theta0, theta1 in rad.
using ProofCell = std::array<double, 6>;

/// place() throws InputError for a value out of its range.
struct PlacementOptions {
  PlacementMethod method = PlacementMethod::kBranchAndBound;
  TileShape shape = TileShape::kTriangle;
  double tolerance_mm = 1e-6;  ///< A tile may overhang the outline by this much, 1e-8 … 1.
  double gap_mm = 0.0;         ///< Facing sides of modules keep this free space, 0 … 100.
  /// This length is cut off along each side from every corner: 0 … design::kMaxCornerCut_mm, triangles only. A tile
  /// then counts if the rest of it lies inside.
  double corner_cut_mm = 0.0;
  double time_limit_s = 60.0;  ///< A value of 0 or less disables the limit.
  /// When the open cells take this much memory (at least 1), the search ends with its best result so far.
  double memory_limit_mb = 2000.0;
  /// Limits the text of the proof (write_proof()), 1 … 100,000. The search ends with its result so far before it
  /// exceeds this.
  double proof_limit_mb = 300.0;
  int threads = 0;  ///< 0 uses all cores; the answer does not depend on it.
  std::uint64_t seed = 1;
  /// These options settle what the paper leaves open for R1 … R7; the seed is the one above.
  paper::HeuristicOptions paper;
  bool keep_proof = false;  ///< Only branch and bound fills PlacementResult::proof.
  /// Receives each cell of the proof as soon as it is closed, on the thread that calls place(); the result then keeps
  /// no cells. Branch and bound only.
  std::function<void(const ProofCell&)> proof_cell;
  /// Branch and bound then selects the optimum with the largest clearance.
  bool largest_clearance = true;
  /// Sets the objective (branch and bound only): the number of tiles; with `connected` the number of tiles connected by
  /// sides; with `weights` the sum of the weights of all tiles. The last two start from the answer of the first, and
  /// clearance and deficit are not computed.
  bool connected = false;
  std::shared_ptr<const WeightMap> weights;
  bool deficit = false;  ///< Branch and bound then computes PlacementResult::deficit_mm.
};

/// Certifies that no placement is better (docs/placement.md has the format). Its motions are q = R(theta)*(p - pivot) +
/// (x, y), in mm and rad.
struct PlacementProof {
  TileShape shape = TileShape::kTriangle;
  Vec2 pivot = Vec2::Zero();
  double pitch_mm = kSide_mm;
  double corner_cut_mm = 0.0;
  std::array<double, 3> motion{};  ///< The answer is given as x, y and theta.
  std::vector<ProofCell> cells;    ///< The cells cover one period of the lattice.
};

struct PlacementResult {
  int modules = 0;      ///< All tiles inside count; with `connected`, only those of the largest connected set.
  int upper_bound = 0;  ///< The bound is proved: no placement has more modules.
  bool proved = false;  ///< Value and bound met before a limit ended the search.
  SearchStop stopped = SearchStop::kNone;  ///< This limit was reached first.
  /// This many `tiles` keep an inset of −tolerance/2 or more, for which the bound holds. If they are fewer than
  /// `modules`, the others overhang by more than half the tolerance, and the bound does not cover them (branch and
  /// bound, by number).
  int modules_within_bound = 0;
  double clearance_mm = 0.0;  ///< `modules` tiles still fit with this inset.
  /// No placement of `modules` tiles has a larger clearance (branch and bound; equals the inradius when not proved).
  double clearance_bound_mm = 0.0;
  /// If every side of every module is drawn in by deficit_mm, one module more fits somewhere; if by less than
  /// deficit_bound_mm, in the separations of docs/placement.md, none does. Empty if even 0.8 inradius is not enough, or
  /// nobody asked.
  std::optional<double> deficit_mm;
  double deficit_bound_mm = 0.0;
  Placement deficit_placement;  ///< At this placement one module more would fit.
  double weight = 0.0;          ///< The sum of the weights is within 1e-5 of the largest.
  double weight_bound = 0.0;    ///< No placement has a larger weight.
  double tolerance_mm = 0.0;
  Placement placement;
  /// The methods R1 … R7 also give the placement in the paper's form.
  std::optional<paper::PivotedPlacement> pivoted;
  std::vector<Tile> tiles;           ///< These grid triangles lie wholly inside; they are sorted.
  std::vector<double> tile_weights;  ///< Each of `tiles` has its weight here if weights are given.
  std::int64_t evaluations = 0;
  std::int64_t cells = 0;
  double search_seconds = 0.0;  ///< Value and bound were known after this time, which is part of `seconds`.
  double seconds = 0.0;
  PlacementProof proof;
};

/// Places `polygon` (mm) on the isometric grid so that as many tiles as possible lie wholly inside; with branch and
/// bound the upper bound is a proof over all translations and angles. Errors: InputError for self-intersecting, empty
/// or non-finite rings (ring and vertex are named), for options out of range or that exclude each other, for
/// polygons that would take more than 10⁶ modules, that reach farther than 1 km from their centre, or that lie so far
/// from the origin that a placement cannot be written down within the tolerance. std::logic_error if the exact check of
/// the answer fails: a wrong answer is never returned. The answer is equal for every number of threads and every
/// processor unless the time limit cuts the search short. Thread-safe. Cost: milliseconds to a minute; time_limit_s
/// bounds the search. Source: docs/placement.md.
[[nodiscard]] PlacementResult place(const Polygon& polygon, const PlacementOptions& options = {},
                                    const ProgressSink& progress = {});

/// Returns the triangles, less `corner_cut_mm` along each side at every corner, that lie in the moved polygon without
/// its holes, each allowed to overhang by `tolerance_mm`, sorted. `polygon` must be normalized (polygon_io.hpp);
/// nothing is checked. Thread-safe. Cost: O(edges · tiles that they pass).
[[nodiscard]] std::vector<Tile> tiles_inside(const Polygon& polygon, const Placement& placement, double tolerance_mm,
                                             double gap_mm = 0.0, double corner_cut_mm = 0.0);

/// Returns the log of `triskin place --proof` as JSON text (docs/placement.md), for the polygon that was placed. It has
/// cells only when PlacementOptions::keep_proof was set; without them the checker rejects it. Cost: linear in the
/// cells.
[[nodiscard]] std::string proof_text(const Polygon& polygon, const PlacementResult& result);

/// Writes the same text part by part while place() runs: add_cell() is for PlacementOptions::proof_cell, finish() is
/// called once, after place(). `write` gets parts of some 64 KiB in their order. Not thread-safe.
class ProofWriter {
 public:
  explicit ProofWriter(std::function<void(std::string_view)> write);
  void add_cell(const ProofCell& cell);
  void finish(const Polygon& polygon, const PlacementResult& result);

 private:
  std::function<void(std::string_view)> write_;
  std::string part_;
  bool first_ = true;
};

}  // namespace triskin::placement
