// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <array>
#include <chrono>
#include <memory>
#include <vector>

#include "kernels/slice_raster.hpp"
#include "search/cell_list.hpp"
#include "triskin/base/progress.hpp"

namespace triskin::placement {

/// The bounds of the parts of a slice are indexed by x, then y.
using PartBounds = std::array<std::array<double, SliceRaster::kSteps>, SliceRaster::kSteps>;

/// The bounds of the parts of a cell are indexed by x + 4·y + 16·theta, like the counts of Lookahead.
inline constexpr std::size_t kCubes = kPartsPerAxis * kLanesPerRow;
using CubeBounds = std::array<double, kCubes>;

/// An objective other than the number of tiles; it must grow with every tile that is inside.
class Objective {
 public:
  virtual ~Objective() = default;
  /// Returns the value of the tiles that are inside at a motion.
  virtual double value(const Motion& motion, const std::vector<Tile>& inside) = 0;
  /// Returns a bound that no motion of the cell exceeds: the certain tiles are inside, any of the open ones may be.
  virtual double bound(const CellFrame& cell, const std::vector<OpenTile>& certain,
                       const std::vector<OpenTile>& open) = 0;
  /// Sets a bound for each part of a slice that no motion of the part exceeds. `raster` has collected the tiles of the
  /// slice.
  virtual void bound_parts(const CellFrame& slice, const SliceRaster& raster, PartBounds& bounds) = 0;
  /// Sets a bound for each part of the cell of the last bound(). `words` tell in which parts its open tiles may be
  /// inside.
  virtual void bound_cubes(const PartsView& view, const std::vector<PartWord>& words, CubeBounds& bounds) const = 0;
  /// Returns a bound for the value at the middle of the cell of the last bound(); it may be lower than that of the
  /// cell.
  [[nodiscard]] virtual double most_at_middle() const = 0;
  /// Returns how many open tiles of the last bound() must be inside for a value over `value`.
  [[nodiscard]] virtual int needed(double value) const = 0;
  /// Returns the slack: a bound of at most this much over `value` counts as proved.
  [[nodiscard]] virtual double slack(double value) const = 0;
};

struct ObjectiveLimits {
  std::chrono::steady_clock::time_point deadline;
  double memory_bytes = 0.0;  ///< The open cells may take this much memory.
};

struct ObjectiveResult {
  double value = 0.0, bound = 0.0;
  bool proved = false;
  SearchStop stopped = SearchStop::kNone;
  Motion motion;
  std::int64_t cells = 0;
};

/// Runs branch and bound for an Objective, like branch_and_bound(), but a cell keeps its certain tiles, not only their
/// number: slices are bounded and cut into cells, which are filtered, contracted and halved. One thread, deterministic;
/// `first` is a motion to begin with, `bound` a known bound of the best value. Cost: less than a microsecond per tile
/// and cell.
[[nodiscard]] ObjectiveResult search_objective(const PreparedPolygon& polygon, const TileGrid& grid,
                                               Objective& objective, double tolerance_mm, const Motion& first,
                                               double bound, const ObjectiveLimits& limits,
                                               const ProgressSink& progress);

}  // namespace triskin::placement
