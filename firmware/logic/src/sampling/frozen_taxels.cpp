// SPDX-License-Identifier: Apache-2.0
#include "triskin/logic/sampling/frozen_taxels.hpp"

#include <cstdlib>

namespace triskin::fw {

std::uint16_t FrozenTaxels::add(const Taxels& raw) {
  int changed = 0, jumped = 0;
  for (std::size_t t = 0; t < raw.size(); ++t) {
    changed += raw[t] != last_[t] ? 1 : 0;
    jumped += std::abs(raw[t] - last_[t]) >= 2 ? 1 : 0;
  }
  std::uint16_t frozen = 0;
  for (std::size_t t = 0; t < raw.size(); ++t) {
    Evidence& still = still_[t];
    if (raw[t] != last_[t]) {
      still = {};
    } else if (changed >= kLively && !still.enough()) {
      still.changes = static_cast<std::uint16_t>(still.changes + changed);
      still.jumps = static_cast<std::uint16_t>(still.jumps + jumped);
    }
    if (still.enough()) frozen = static_cast<std::uint16_t>(frozen | 1U << t);
  }
  last_ = raw;
  return frozen;
}

}  // namespace triskin::fw
