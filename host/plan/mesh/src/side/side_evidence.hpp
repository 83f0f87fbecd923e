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

namespace triskin::mesh {

/// Collects the evidence for the side of one region.
struct RegionEvidence {
  double area_mm2 = 0.0, walled_mm2 = 0.0;
  double self_mm2 = 0.0;         ///< Over this area the partner lies in the same region, as on a thin rod.
  double border_mm = 0.0;        ///< The edges to other regions and to the border have this total length.
  double wall_mm = 0.0;          ///< The thickness is the median over the region.
  double outwardness = 0.0;      ///< The mean over the region's samples lies in −1 … 1.
  double outwardness_mm2 = 0.0;  ///< The mean counts as evidence for this area, since thick places count less.
  double visibility = 1.0, hull_depth_mm = 0.0;
  int component = 0;
};

/// The lower number comes first.
using RegionPair = std::pair<int, int>;

/// Holds the evidence of each region and the relations between regions.
struct SideEvidence {
  std::vector<RegionEvidence> regions;
  std::map<RegionPair, double> across_mm2;  ///< Two regions are the two sides of one wall over this area.
  std::map<RegionPair, double> beside_mm;   ///< The edges between two regions have this length.
  std::vector<bool> is_component_closed;
  std::vector<bool> is_component_enclosed;  ///< The component lies wholly inside another one, as a board in its cover.
};

/// Gathers the evidence. Each sample measures the visibility and the depth under the convex hull here and across the
/// wall. Samples are chosen by area, so that the cost does not grow with the number of faces. Cost: about 400,000 rays.
[[nodiscard]] SideEvidence side_evidence(const RayCaster& part, const std::vector<std::array<FaceIndex, 3>>& neighbours,
                                         const SmoothRegions& regions, const std::vector<WallSample>& samples,
                                         const SideOptions& options);

}  // namespace triskin::mesh
