// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <iterator>

#include "triskin/hardware/effects.hpp"

namespace triskin::hardware {

double value_at(const std::vector<TimedValue>& points, std::uint64_t at_us) {
  if (points.empty()) return 0.0;
  const auto next = std::ranges::upper_bound(points, at_us, {}, &TimedValue::at_us);
  if (next == points.begin()) return next->value;
  const TimedValue& last = *std::prev(next);
  if (next == points.end()) return last.value;
  const double share = static_cast<double>(at_us - last.at_us) / static_cast<double>(next->at_us - last.at_us);
  return last.value + share * (next->value - last.value);
}

double temperature_counts(const TemperatureEffect& effect, std::uint64_t at_us) {
  return effect.counts_per_degree * (value_at(effect.celsius, at_us) - value_at(effect.celsius, 0));
}

}  // namespace triskin::hardware
