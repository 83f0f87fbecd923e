// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "triskin/geometry/placement.hpp"

namespace triskin::geometry {

/// The paper's Algorithm 1 as it was published, in CGAL kernels: every grid triangle of the polygon's bounding box
/// whose three sides do not cross the outline and whose corner lies inside. The baseline of `bench placement`; never
/// used for answers, since a hole inside a triangle escapes the three-sides test. Cost: O(tiles · edges).
[[nodiscard]] int paper_algorithm1(const Polygon& polygon, const Placement& placement, bool exact_constructions);

/// How many placements R4 (60 angles, 1 mm steps) evaluates.
[[nodiscard]] constexpr int r4_evaluations() {
  return 60 * 30 * 26;
}

}  // namespace triskin::geometry
