// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cmath>

namespace triskin::mechanics {

/// Finds the root of the increasing function `f` in [low, high], where it changes its sign, by the Illinois variant of
/// false position. The result is exact to `tolerance` of the interval's upper end.
[[nodiscard]] double root_between(double low, double high, const auto& f, double tolerance = 1e-12) {
  double at_low = f(low), at_high = f(high);
  double x = high;
  for (int step = 0; step < 200 && std::abs(high - low) > tolerance * std::abs(high); ++step) {
    const double before = x;
    x = (low * at_high - high * at_low) / (at_high - at_low);
    if (std::abs(x - before) <= tolerance * std::abs(x) / 4.0) break;
    const double at_x = f(x);
    if (at_x == 0.0) return x;
    if (at_x > 0.0) {
      high = x;
      at_high = at_x;
      at_low /= 2.0;
    } else {
      low = x;
      at_low = at_x;
      at_high /= 2.0;
    }
  }
  return x;
}

}  // namespace triskin::mechanics
