// SPDX-License-Identifier: Apache-2.0
#include "triskin/logic/sampling/module_reading.hpp"

namespace triskin::fw {

using wire::ModuleState;

void ModuleReading::store(const ad7147::Results& results, std::uint16_t frozen) {
  raw = results;
  std::uint16_t inside = 0;
  for (std::size_t t = 0; t < raw.size(); ++t) {
    if (ad7147::in_range(raw[t])) inside = static_cast<std::uint16_t>(inside | 1U << t);
  }
  valid = static_cast<std::uint16_t>(inside & ~frozen);
  state = inside != ad7147::kAllStages ? ModuleState::kSaturated
          : frozen != 0                ? ModuleState::kFrozen
                                       : ModuleState::kOk;
  compensation.add(raw, valid);
}

void ModuleReading::store_failure(ModuleState why) {
  valid = 0;
  state = why;
}

void ModuleReading::publish(std::uint64_t at_us) {
  ++number;
  time_us = at_us;
  fresh = true;
  unheard = 0;
}

}  // namespace triskin::fw
