// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <chrono>
#include <cstdint>
#include <functional>
#include <vector>

#include "kernels/tile_polygon.hpp"
#include "search/cell_expander.hpp"
#include "triskin/base/progress.hpp"
#include "triskin/placement/placement.hpp"

namespace triskin::placement {

/// States the goal of one branch and bound, and when it may end.
struct SearchGoal {
  /// The bound holds for tiles whose separation from every edge is at least this, less half the tolerance unless
  /// `raise` is set.
  double inset_mm = 0.0;
  double tolerance_mm = 1e-6;   ///< A motion's value counts tiles with a separation of at least inset − tolerance.
  double resolution_mm = 1e-8;  ///< Smaller cells are not split, so their bound stays open.
  int known = 0;                ///< This value is already known, so only better ones are of interest.
  std::function<void(const ProofCell&)> closed =
      nullptr;  ///< Receives boxes that cover the period, each with a bound of at most upper_bound.
  /// If set, values over `known` are not the aim but raise the inset. The function is called with a motion of such a
  /// value and returns the inset (not less than before) and the tolerance to continue with. Above last_inset_mm the
  /// search ends.
  std::function<std::array<double, 2>(const Motion&)> raise;
  double last_inset_mm = 0.0;
  /// If set, only these slices are searched; they are SearchResult::tied_slices of a search for more tiles than known.
  const std::vector<MotionBox>* slices = nullptr;
  int threads = 0;  ///< 0 uses all cores; no answer depends on the number.
  std::chrono::steady_clock::time_point deadline = std::chrono::steady_clock::time_point::max();
  double memory_limit_bytes = 2e9;      ///< The open cells may take this much memory.
  double unpacked_bytes = 24e6;         ///< Above this their lists are packed, and edges are looked up twice.
  std::int64_t max_closed = INT64_MAX;  ///< `closed` is called at most about this often.
};

struct SearchResult {
  int best = 0;         ///< The best value found is never below `known`.
  Motion motion;        ///< The motion is set only if best > known.
  bool found = false;   ///< True means that best > known.
  int upper_bound = 0;  ///< No motion has a higher value at goal.inset_mm (with `raise`, at the last inset).
  std::vector<MotionBox> tied_slices;  ///< Outside these slices no motion has `best` tiles.
  std::vector<Motion> as_good;  ///< These motions reach `best` in the filtered lists; they are not counted exactly.
  std::int64_t cells = 0;
  std::int64_t evaluations = 0;
  SearchStop stopped = SearchStop::kNone;
};

/// Branch and bound over (x, y, theta): cells keep the undecided tiles, each with the edges that may still cut it.
/// Bounds are first order with pads for curvature and rounding; contraction clips a cell to where enough tiles can
/// hold, and its 64 parts are bounded before it is divided.
[[nodiscard]] SearchResult branch_and_bound(const PreparedPolygon& polygon, const TileGrid& grid,
                                            const SearchGoal& goal, const ProgressSink& progress = {});

}  // namespace triskin::placement
