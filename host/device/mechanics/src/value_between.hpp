// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstddef>
#include <span>

namespace triskin::mechanics {

/// Interpolates linearly between equidistant values; `position` (≥ 0) counts in steps from the first one. Behind the
/// last value it is 0, as there a profile has fallen to nothing. Constant cost.
[[nodiscard]] inline double value_between(std::span<const double> values, double position) {
  if (!(position < static_cast<double>(values.size()) - 1.0)) return 0.0;
  const auto k = static_cast<std::size_t>(position);
  return values[k] + (position - static_cast<double>(k)) * (values[k + 1] - values[k]);
}

}  // namespace triskin::mechanics
