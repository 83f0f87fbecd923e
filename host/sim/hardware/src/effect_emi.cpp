// SPDX-License-Identifier: GPL-3.0-or-later
#include <cmath>

#include "triskin/hardware/effects.hpp"

namespace triskin::hardware {

double emi_deviation_counts(const std::vector<EmiBurst>& bursts, std::uint64_t at_us) {
  double variance = 0.0;
  for (const EmiBurst& b : bursts) {
    if (at_us < b.from_us) continue;
    const std::uint64_t after_us = b.every_us == 0 ? at_us - b.from_us : (at_us - b.from_us) % b.every_us;
    if (after_us < b.length_us) variance += b.counts * b.counts;
  }
  return std::sqrt(variance);
}

}  // namespace triskin::hardware
