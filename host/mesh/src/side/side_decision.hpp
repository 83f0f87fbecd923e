// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "side_evidence.hpp"

namespace triskin::geometry {

/// Labels of the regions, and whether they are certain.
struct SideDecision {
  std::vector<FaceSide> side;        ///< There is one for each region.
  std::vector<double> outwardness;   ///< It lies in −1 … 1, after each region took its neighbours into account.
  std::vector<std::uint8_t> choice;  ///< It is 1 or 2 for undecided regions, otherwise 0.
  bool has_wall = false, is_certain = true;
  bool has_loose_sheets = false;
  double margin = 1.0;
  int enclosed = 0;  ///< So many components lie wholly inside of another one.
};

/// Decides. Regions across a wall should differ, regions beside each other should agree, each should follow its own
/// evidence: the least sum of squares of what is not so. Deterministic. Cost: O(regions and their pairs) a pass.
[[nodiscard]] SideDecision decide_sides(const SideEvidence& evidence, const SideOptions& options);

}  // namespace triskin::geometry
