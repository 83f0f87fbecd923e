// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "side_evidence.hpp"

namespace triskin::geometry {

/// Labels of the regions, and whether they are certain.
struct SideDecision {
  std::vector<FaceSide> side;        ///< a region each
  std::vector<double> outwardness;   ///< −1 … 1, after regions have heard each other
  std::vector<std::uint8_t> choice;  ///< 1 or 2 of undecided regions, else 0
  bool has_wall = false, is_certain = true;
  bool has_loose_sheets = false;
  double margin = 1.0;
};

/// Decides. Regions across a wall should differ, regions beside each other should agree, each should follow its own
/// evidence: the least sum of squares of what is not so. Deterministic. Cost: O(regions and their pairs) a pass.
[[nodiscard]] SideDecision decide_sides(const SideEvidence& evidence, const SideOptions& options);

}  // namespace triskin::geometry
