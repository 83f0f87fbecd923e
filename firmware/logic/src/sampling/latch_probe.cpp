// SPDX-License-Identifier: Apache-2.0
#include "triskin/logic/sampling/latch_probe.hpp"

#include <cstdlib>

namespace triskin::fw {

void LatchProbe::store(const ad7147::Results& results) {
  middle_ = results;
  probed_ = true;
}

// If a finger touches during the probe, the middle result agrees with neither, and there is no verdict.
void LatchProbe::compare(const ad7147::Results& before, const ad7147::Results& after) {
  constexpr std::uint32_t kNoise = 20 * kStages, kClear = 4;
  if (!wanted()) return;
  std::uint32_t from_before = 0, from_after = 0;
  for (std::size_t s = 0; probed_ && s < kStages; ++s) {
    from_before += static_cast<std::uint32_t>(std::abs(static_cast<int>(middle_[s]) - static_cast<int>(before[s])));
    from_after += static_cast<std::uint32_t>(std::abs(static_cast<int>(middle_[s]) - static_cast<int>(after[s])));
  }
  probed_ = false;
  if (from_before > kClear * from_after + kNoise)
    latching_ = wire::Latching::kEachStage;
  else if (from_after > kClear * from_before + kNoise)
    latching_ = wire::Latching::kEndOfSequence;
  else if (++probes_ >= kMaxProbes)
    latching_ = wire::Latching::kEachStage;
}

}  // namespace triskin::fw
