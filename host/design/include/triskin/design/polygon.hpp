// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <vector>

#include "triskin/design/mesh.hpp"

namespace triskin::design {

/// Polygon with holes in mm. Rings are open (last point not repeated); outer counter-clockwise, holes clockwise. A
/// plain value: geometry::normalize_polygon brings any input into this form and refuses what has none.
struct Polygon {
  std::vector<Vec2> outer;
  std::vector<std::vector<Vec2>> holes;
};

}  // namespace triskin::design
