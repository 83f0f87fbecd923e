// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <vector>

#include "triskin/design/design_types.hpp"

namespace triskin::lattice {

/// Two modules that overlap as penetration_depth() measures it.
struct OverlappingPair {
  int a, b;
  double depth_mm;
};

/// Returns all pairs of the layout that overlap. Cost: some µs per module.
[[nodiscard]] std::vector<OverlappingPair> overlapping_pairs(const ModuleLayout& layout);

/// Does what measure_between() does, with known pairs. Cost: that of the joints.
void measure_between(ModuleLayout& layout, const std::vector<OverlappingPair>& pairs);

}  // namespace triskin::lattice
