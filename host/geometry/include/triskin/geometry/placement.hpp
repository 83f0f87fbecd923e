// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "triskin/geometry/design_types.hpp"
#include "triskin/geometry/paper/heuristics.hpp"
#include "triskin/geometry/weight_map.hpp"
#include "triskin/host/progress.hpp"

namespace triskin::geometry {

enum class PlacementMethod {
  kBranchAndBound,  ///< certified
  // The heuristics of the reference paper (paper/heuristics.hpp): triangles without gap.
  kR1,
  kR2,
  kR3,
  kR4,
  kR5,
  kR6,
  kR7,
  // Grid scans and descents (docs/placement.md): every shape and gap.
  kScanEdges,
  kScanSlides,
  kScanShifts,
  kScanAngles,
  kScanEdgeAngles,
  kRandom,
  kDescent
};
enum class TileShape { kTriangle, kHexagon, kSquare };

struct PlacementOptions {
  PlacementMethod method = PlacementMethod::kBranchAndBound;
  TileShape shape = TileShape::kTriangle;
  double tolerance_mm = 1e-6;  ///< ε: a tile counts when it lies in P inset by ε (docs/placement.md)
  double gap_mm = 0.0;         ///< free space between facing sides of modules
  double time_limit_s = 60.0;  ///< ≤ 0: none
  int threads = 0;             ///< 0: all cores; the answer does not depend on it
  std::uint64_t seed = 1;
  paper::HeuristicOptions paper;  ///< what the paper leaves open of R1 … R7; the seed is the one above
  bool keep_proof = false;        ///< fill PlacementResult::proof (branch and bound only)
  bool largest_clearance = true;  ///< among the optima the placement with the largest clearance (branch and bound only)
  /// What is made as large as possible (branch and bound only): the number of tiles; of tiles that hang together by
  /// sides; or the sum of the weights of all tiles. The last two search on from the answer of the first, and leave
  /// clearance and deficit out.
  bool connected = false;
  std::shared_ptr<const WeightMap> weights;
  bool deficit = false;  ///< how far sides must give way for one module more (branch and bound only)
};

/// What a checker needs to see that no placement is better (docs/placement.md): motions q = R(theta)·(p − pivot) +
/// (x, y).
struct PlacementProof {
  std::string shape = "triangle";  ///< or "square", "hexagon"
  Vec2 pivot = Vec2::Zero();
  double pitch_mm = kSide_mm;
  std::array<double, 3> motion{};            ///< x, y, theta of the answer
  std::vector<std::array<double, 6>> cells;  ///< boxes x0, x1, y0, y1, theta0, theta1 that cover one period
};

struct PlacementResult {
  int modules = 0;
  int upper_bound = 0;
  bool proved = false;
  double clearance_mm = 0.0;  ///< inset at which `modules` tiles still fit
  double clearance_bound_mm =
      0.0;  ///< no placement of `modules` tiles has a larger clearance (method bnb; the inradius when not proved)
  /// With every side of every module drawn in by deficit_mm one module more fits somewhere (empty: not even with 0.8
  /// inradius, or not asked for); with less than deficit_bound_mm, in the separations of docs/placement.md, none does.
  std::optional<double> deficit_mm;
  double deficit_bound_mm = 0.0;
  Placement deficit_placement;  ///< where one module more would fit
  double weight = 0.0;          ///< with weights: their sum, to 1e-5 of it as large as any
  double weight_bound = 0.0;    ///< no placement has more
  double tolerance_mm = 0.0;
  Placement placement;
  std::optional<paper::PivotedPlacement> pivoted;  ///< methods R1 … R7: the placement as the paper has it
  std::vector<Tile> tiles;                         ///< grid triangles wholly inside, sorted
  std::int64_t evaluations = 0;
  std::int64_t cells = 0;
  double search_seconds = 0.0;  ///< of that until value and bound stood
  double seconds = 0.0;
  PlacementProof proof;
};

/// Places `polygon` on the isometric grid so that as many tiles as possible lie wholly inside.
/// Errors: InputError for open, self-intersecting, empty or non-finite rings, with ring and vertex index.
[[nodiscard]] PlacementResult place(const Polygon& polygon, const PlacementOptions& options = {},
                                    const ProgressSink& progress = {});

/// The tiles that lie in the moved polygon, each allowed to stand over by
/// `tolerance_mm`, sorted. `polygon` must be normalized (polygon_io.hpp). Cost: O(edges · tiles that they pass).
[[nodiscard]] std::vector<Tile> tiles_inside(const Polygon& polygon, const Placement& placement, double tolerance_mm,
                                             double gap_mm = 0.0);

/// The log of `triskin place --proof` (docs/placement.md) for the polygon that was placed. Cells are there when
/// `keep_proof` was set.
[[nodiscard]] std::string proof_text(const Polygon& polygon, const PlacementResult& result);

}  // namespace triskin::geometry
