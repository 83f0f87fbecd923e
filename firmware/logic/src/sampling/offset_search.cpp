// SPDX-License-Identifier: Apache-2.0
#include "triskin/logic/sampling/offset_search.hpp"

#include <algorithm>
#include <cstdlib>

namespace triskin::fw {

void OffsetSearch::begin() {
  *this = {};
  offsets_.fill(kFirst);
  last_excess_.fill(kAtEnd);
}

void OffsetSearch::begin(const ad7147::Offsets& known) {
  begin();
  offsets_ = known;
  known_ = true;
}

// All stages have the same offset DAC, so the changes of all of them are one measurement.
void OffsetSearch::measure_step(const Excess& excess) {
  constexpr std::int32_t kMinSteps = 8;  // Noise and uneven steps spoil a measurement over fewer.
  std::int32_t steps = 0, counts = 0;
  for (std::size_t t = 0; t < excess.size(); ++t) {
    if (excess[t] == kAtEnd || last_excess_[t] == kAtEnd) continue;
    steps += std::abs(offsets_[t] - last_offsets_[t]);
    counts += std::abs(last_excess_[t] - excess[t]);
  }
  if (steps >= kMinSteps) step_counts_ = std::clamp(counts / steps, kMinStep_counts, kMaxStep_counts);
}

std::uint8_t OffsetSearch::better(std::uint8_t offset, std::int32_t excess, bool at_end) const {
  const std::int32_t far = at_end ? kFarStep : (std::abs(excess) + step_counts_ / 2) / step_counts_;
  return static_cast<std::uint8_t>(std::clamp<std::int32_t>(offset + (excess < 0 ? -far : far), 0, ad7147::kMaxOffset));
}

bool OffsetSearch::adjust(const ad7147::Results& results, Ad7147::Polarity polarity) {
  Excess excess{};
  for (std::size_t t = 0; t < results.size(); ++t) {
    const std::int32_t above = static_cast<std::int32_t>(results[t]) - static_cast<std::int32_t>(ad7147::kMidScale);
    excess[t] = polarity == Ad7147::Polarity::kPositive ? above : -above;
  }
  Excess comparable = excess;
  for (std::size_t t = 0; t < results.size(); ++t) {
    if (!ad7147::in_range(results[t])) comparable[t] = kAtEnd;
  }
  measure_step(comparable);
  last_excess_ = comparable;
  last_offsets_ = offsets_;

  const std::int32_t limit = known_ || rounds_ >= kCenteringRounds ? kThird : step_counts_;
  const bool last = ++rounds_ >= kMaxRounds;
  bool changed = false;
  outside_ = 0;
  for (std::size_t t = 0; t < results.size(); ++t) {
    if (std::abs(excess[t]) > kThird) outside_ = static_cast<std::uint16_t>(outside_ | 1U << t);
    if (std::abs(excess[t]) <= limit || last) continue;
    const std::uint8_t offset = better(offsets_[t], excess[t], comparable[t] == kAtEnd);
    changed = changed || offset != offsets_[t];
    offsets_[t] = offset;
  }
  if (changed) return true;
  known_ = true;
  rounds_ = 0;
  return false;
}

}  // namespace triskin::fw
