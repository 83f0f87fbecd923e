// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "kernels/tile_polygon.hpp"

namespace triskin::placement {

struct ScanResult {
  Motion motion;
  int modules = -1;
  std::int64_t evaluations = 0;
};

/// Runs grid scans and descents and returns the best of a list of placements (docs/placement.md says what each method
/// lists), for every shape of tiles and any gap. Deterministic for a seed; ends early at options.time_limit_s.
[[nodiscard]] ScanResult run_scan(const PreparedPolygon& polygon, const TileGrid& grid,
                                  const PlacementOptions& options);

/// Runs the descent of kDescent from one start.
[[nodiscard]] ScanResult descend(const PreparedPolygon& polygon, const TileGrid& grid, double tolerance_mm,
                                 const Motion& start);

}  // namespace triskin::placement
