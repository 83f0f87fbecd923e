// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <chrono>
#include <cstdint>
#include <vector>

#include "tile_polygon.hpp"
#include "triskin/host/progress.hpp"

namespace triskin::geometry {

/// What the search looks for and when it may end.
struct SearchGoal {
  double inset_mm = 0.0;      ///< the bound holds for tiles whose separation from every edge is at least this
  double tolerance_mm = 1e-6; ///< a motion's value counts tiles with a separation of at least inset − tolerance
  double pitch_mm = kSide_mm;
  double resolution_mm = 1e-8; ///< cells smaller than this are not split: their bound stays open
  int known = 0;             ///< value that is already known: only better ones are of interest
  std::vector<std::array<double, 6>>* cells = nullptr;  ///< gets boxes that cover the period, each with a bound of at most upper_bound
  bool stop_at_first = false;  ///< end as soon as anything better than `known` is found
  std::chrono::steady_clock::time_point deadline = std::chrono::steady_clock::time_point::max();
};

struct SearchResult {
  int best = 0;          ///< best value found (≥ known)
  Motion motion;         ///< where, when best > known
  bool found = false;    ///< best > known
  int upper_bound = 0;   ///< no motion has a higher value at goal.inset_mm
  std::int64_t cells = 0;
  std::int64_t evaluations = 0;
};

/// Branch and bound over (x, y, theta): cells keep the undecided tiles, each with the edges that may still cut it.
/// Bounds are first order with curvature and rounding pads; contraction clips a cell to where enough tiles can hold.
[[nodiscard]] SearchResult branch_and_bound(const PreparedPolygon& polygon, const SearchGoal& goal,
                                            const ProgressSink& progress = {});

}  // namespace triskin::geometry
