// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <vector>

#include "triskin/fabrication/flat_island.hpp"

namespace triskin::fabrication {

using Ring = std::vector<design::Vec2>;

/// Turns a point counter-clockwise around (0, 0). Constant cost.
[[nodiscard]] design::Vec2 rotated(const design::Vec2& p, double angle_rad);

/// Returns the area within a ring, negative if it runs clockwise. Cost: linear.
[[nodiscard]] double area_within(const Ring& ring);

}  // namespace triskin::fabrication
