// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <array>
#include <map>
#include <utility>
#include <vector>

#include "ray_caster.hpp"
#include "smooth_regions.hpp"
#include "triskin/mesh/side.hpp"
#include "wall.hpp"

namespace triskin::geometry {

/// What speaks for the side of one region.
struct RegionEvidence {
  double area_mm2 = 0.0, walled_mm2 = 0.0;
  double self_mm2 = 0.0;         ///< area whose partner is in the same region, as on a thin rod
  double border_mm = 0.0;        ///< length of its edges to other regions and to the border
  double wall_mm = 0.0;          ///< median
  double outwardness = 0.0;      ///< −1 … 1, mean over its samples
  double outwardness_mm2 = 0.0;  ///< area that this mean speaks for: thick places count less
  double visibility = 1.0, hull_depth_mm = 0.0;
  int component = 0;
};

/// Two regions, the lesser number first.
using RegionPair = std::pair<int, int>;

/// Evidence of all regions and what they say of each other.
struct SideEvidence {
  std::vector<RegionEvidence> regions;
  std::map<RegionPair, double> across_mm2;  ///< area over which two regions are the two sides of one wall
  std::map<RegionPair, double> beside_mm;   ///< length of the edges between two regions
  std::vector<bool> is_component_closed;
};

/// Gathers it: per sample the part of the sky and the depth under the convex hull here and across the wall. Samples are
/// chosen by area, so that the cost does not grow with the faces. Cost: about 400,000 rays.
[[nodiscard]] SideEvidence side_evidence(const RayCaster& part, const std::vector<std::array<int, 3>>& neighbours,
                                         const SmoothRegions& regions, const std::vector<WallSample>& samples,
                                         const SideOptions& options);

}  // namespace triskin::geometry
