// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <functional>

#include "walled_parts.hpp"

namespace triskin::testing {

/// Makes a sheet over (u, v) ∈ [0, 1]² with a wall behind it and a rim of `rim_facets` around it: 1 is a sharp edge,
/// 6 and more a round one. Adds it to the part; outside is where du × dv points.
struct ShellSolid {
  std::function<design::Vec3(double u, double v)> sheet;
  std::function<double(double u, double v)> wall_mm;
  int columns = 60, rows = 40;
  int rim_facets = 1;
  bool wraps = false;  ///< True for a ring, in which u = 1 meets u = 0.

  void append_to(WalledPart& part) const;
};

}  // namespace triskin::testing
