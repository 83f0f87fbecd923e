// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <vector>

#include "triskin/placement/weight_map.hpp"

namespace triskin::placement {

/// States the criteria of a placement by region: how likely a contact is there, and what the skin weighs (the reference
/// paper's criteria besides area).
struct WeightRegions {
  struct Region {
    /// The outline is a simple ring of at least three points in the frame of the polygon, in either direction.
    std::vector<Vec2> outline_mm;
    double weight = 0.0;  ///< A module whose centre lies in the region is worth this, 0 … 1e12.
  };
  std::vector<Region> regions;  ///< If regions overlap, the last one counts.
  double elsewhere = 0.0;       ///< A module in no region is worth this, 0 … 1e12.
  /// Subtracted from the worth of every module, 0 to 1e12, in the same unit. A result below 0 counts as 0, like a
  /// module that is not built.
  double module_weight = 0.0;
  /// The raster has this positive step; the worth changes over about two steps at the rim of a region.
  double step_mm = 5.0;
};

/// Returns the worth as a map for PlacementOptions::weights. Errors: InputError for no region, a ring of fewer than
/// three points or with numbers that are not finite, weights out of range, and a step that is not positive or gives
/// more than a million points. Cost: points of the raster times edges.
[[nodiscard]] WeightMap weight_map_of(const WeightRegions& wanted);

}  // namespace triskin::placement
