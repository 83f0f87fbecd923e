// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

namespace triskin::lattice {

/// Returns a bound for searches of closest points that contains the distance itself, for distances in mm.
[[nodiscard]] constexpr double search_bound(double distance_mm) {
  return (1.0 + 1e-9) * distance_mm + 1e-9;
}

}  // namespace triskin::lattice
