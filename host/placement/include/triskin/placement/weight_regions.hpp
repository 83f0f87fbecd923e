// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <vector>

#include "triskin/placement/weight_map.hpp"

namespace triskin::geometry {

/// Criteria of a placement by region: how likely a contact is there, and what the skin weighs (the reference paper's
/// criteria besides area).
struct WeightRegions {
  struct Region {
    std::vector<Vec2> outline_mm;  ///< simple ring in the frame of the polygon, either sense, at least three points
    double weight = 0.0;           ///< 0 … 1e12: value of a module whose centre lies in it
  };
  std::vector<Region> regions;  ///< the last one counts where regions overlap
  double elsewhere = 0.0;       ///< 0 … 1e12: value of a module in no region
  double module_weight = 0.0;   ///< 0 to 1e12, in the same unit: taken off the worth of every module; what is then left
                                ///< below 0 counts 0, as a module that is not built
  double step_mm = 5.0;         ///< > 0, of the raster; the worth changes over about two steps at the rim of a region
};

/// The worth as a map for PlacementOptions::weights. Errors: InputError for no region, a ring of fewer than three
/// points or with numbers that are not finite, weights out of range, and a step that is not positive or gives more than
/// a million points. Cost: points of the raster times edges.
[[nodiscard]] WeightMap weight_map_of(const WeightRegions& wanted);

}  // namespace triskin::geometry
