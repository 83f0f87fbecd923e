// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <chrono>
#include <optional>
#include <vector>

#include "kernels/pair_kernel.hpp"
#include "kernels/tile_polygon.hpp"
#include "triskin/base/progress.hpp"

namespace triskin::placement {

/// States the goal of largest_clearance(): the largest inset with which `modules` tiles still fit. With a negative
/// inset the sides of every tile are drawn in by its absolute value.
struct ClearanceGoal {
  int modules = 0;
  double min_inset_mm = 0.0;  ///< Smaller insets do not count; must exceed −0.8 inradius.
  double max_inset_mm = 0.0;  ///< The answer is never above this.
  /// At this motion Evaluator counts `modules` tiles with min_inset_mm, which is the answer in the worst case.
  std::optional<Motion> known = std::nullopt;
  std::vector<Motion> starts;  ///< The ascent starts from each of these motions.
  /// If set, only these slices are searched, because outside them no inset ≥ 0 lets `modules` tiles fit.
  const std::vector<MotionBox>* slices = nullptr;
  int threads = 0;                  ///< 0 uses all cores; the answer does not depend on it.
  double memory_limit_bytes = 2e9;  ///< The open cells may take this much memory.
  std::chrono::steady_clock::time_point deadline = std::chrono::steady_clock::time_point::max();
};

struct Clearance {
  bool found = false;  ///< The tiles fit with inset_mm at `motion`.
  double inset_mm = 0.0;
  double bound_mm = 0.0;  ///< No motion lets them fit with more (max_inset_mm if the deadline came first).
  Motion motion;
  std::int64_t cells = 0, evaluations = 0;
};

/// Climbs from the best of the starts, then asks branch and bound for a motion with a larger inset, until there is
/// none: that is the proof. inset_mm and bound_mm differ by at most 5 µm or 2 %.
[[nodiscard]] Clearance largest_clearance(const PreparedPolygon& polygon, const TileGrid& grid,
                                          const ClearanceGoal& goal, const ProgressSink& progress);

}  // namespace triskin::placement
