// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "placement/kernels/tile_polygon.hpp"

namespace triskin::geometry {

struct HeuristicResult {
  Motion motion;
  int modules = -1;
  std::int64_t evaluations = 0;
};

/// The paper's scheme: Algorithm 1 evaluates a placement, Algorithm 2 keeps the best of a list, R1–R7 make the lists
/// (docs/placement.md says what each list holds). Deterministic for a seed.
/// `descents` is the number of random starts of R7.
[[nodiscard]] HeuristicResult run_heuristic(const PreparedPolygon& polygon, const TileGrid& grid,
                                            const PlacementOptions& options, int descents = 40);

}  // namespace triskin::geometry
