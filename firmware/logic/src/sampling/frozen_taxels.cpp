// SPDX-License-Identifier: Apache-2.0
#include "triskin/logic/sampling/frozen_taxels.hpp"

namespace triskin::fw {

std::uint16_t FrozenTaxels::add(const Taxels& raw) {
  int changed = 0;
  for (std::size_t t = 0; t < raw.size(); ++t) changed += raw[t] != last_[t] ? 1 : 0;
  std::uint16_t frozen = 0;
  for (std::size_t t = 0; t < raw.size(); ++t) {
    std::uint16_t& still = still_[t];
    if (raw[t] != last_[t])
      still = 0;
    else if (changed >= kLively && still < kFrozenChanges)
      still = static_cast<std::uint16_t>(still + changed);
    if (still >= kFrozenChanges) frozen = static_cast<std::uint16_t>(frozen | 1U << t);
  }
  last_ = raw;
  return frozen;
}

}  // namespace triskin::fw
