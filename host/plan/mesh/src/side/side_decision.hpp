// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "side_evidence.hpp"

namespace triskin::mesh {

/// Labels the regions and tells whether the labels are certain.
struct SideDecision {
  std::vector<FaceSide> side;
  /// The value lies in −1 … 1 and already includes the influence of neighbouring regions.
  std::vector<double> outwardness;
  std::vector<std::uint8_t> choice;  ///< Undecided regions have 1 or 2, all others 0.
  bool has_wall = false, is_certain = true;
  bool has_loose_sheets = false;
  double margin = 1.0;
  int enclosed = 0;  ///< This many components lie wholly inside another one.
};

/// Decides the side of each region by least squares: regions across a wall should differ, regions beside each other
/// should agree, and each should follow its own evidence. Deterministic. Cost: O(regions and their pairs) per pass.
[[nodiscard]] SideDecision decide_sides(const SideEvidence& evidence, const SideOptions& options);

}  // namespace triskin::mesh
