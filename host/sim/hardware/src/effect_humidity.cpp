// SPDX-License-Identifier: GPL-3.0-or-later
#include "triskin/hardware/effects.hpp"

namespace triskin::hardware {

double humidity_counts(const HumidityEffect& effect, double unit, std::uint64_t at_us) {
  const double change = value_at(effect.percent, at_us) - value_at(effect.percent, 0);
  return effect.counts_per_percent * (1.0 + effect.spread * unit) * change;
}

}  // namespace triskin::hardware
