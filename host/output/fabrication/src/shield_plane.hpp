// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <vector>

#include "ring.hpp"

namespace triskin::fabrication {

/// Returns the plane that ACSHIELD drives on the first inner layer of a module whose centroid lies at `center_mm` and
/// which is turned counter-clockwise by `angle_rad`, in whole units of 0.0001 mm: everything farther than
/// kShieldInset_mm from the sides, with a gap of kClearance_mm around every plated hole of another net. Holes are
/// joined to the outer ring by vertical cuts of no width, which readers of boards bear only if they are exactly
/// vertical; so they are made where the module lies. The same for every corner cut up to kMaxBoardCornerCut_mm. Cost:
/// some milliseconds.
[[nodiscard]] std::vector<Ring> shield_plane(const design::Vec2& center_mm, double angle_rad);

}  // namespace triskin::fabrication
