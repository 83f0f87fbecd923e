// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <vector>

#include "triskin/design/mesh.hpp"

namespace triskin::design {

/// A polygon in mm can have holes. Rings are open (the last point is not repeated); the outer ring runs
/// counter-clockwise, holes clockwise. The struct checks nothing; placement::normalize_polygon brings any input into
/// this form, or refuses it.
struct Polygon {
  std::vector<Vec2> outer;
  std::vector<std::vector<Vec2>> holes;
};

}  // namespace triskin::design
