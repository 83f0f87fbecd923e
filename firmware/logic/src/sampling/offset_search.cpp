// SPDX-License-Identifier: Apache-2.0
#include "triskin/logic/sampling/offset_search.hpp"

#include <algorithm>
#include <cstdlib>

namespace triskin::fw {

void OffsetSearch::begin() {
  *this = {};
  offsets_.fill(kFirst);
}

void OffsetSearch::begin(const ad7147::Offsets& known) {
  *this = {};
  offsets_ = known;
  known_ = true;
}

// `excess_counts` says by how much the electrode exceeds its offset.
std::uint8_t OffsetSearch::better(std::uint8_t offset, std::int32_t excess_counts, bool at_end) {
  constexpr std::int32_t kHalf = ad7147::kOffsetCounts / 2;
  const std::int32_t far = at_end ? kFarStep : (std::abs(excess_counts) + kHalf) / ad7147::kOffsetCounts;
  const std::int32_t moved = offset + (excess_counts < 0 ? -far : far);
  return static_cast<std::uint8_t>(std::clamp<std::int32_t>(moved, 0, ad7147::kMaxOffset));
}

bool OffsetSearch::adjust(const ad7147::Results& results, Ad7147::Polarity polarity) {
  const std::int32_t limit = known_ || rounds_ >= kCenteringRounds ? kThird : ad7147::kOffsetCounts;
  bool changed = false;
  outside_ = 0;
  for (std::size_t t = 0; t < results.size(); ++t) {
    const std::int32_t above = static_cast<std::int32_t>(results[t]) - static_cast<std::int32_t>(ad7147::kMidScale);
    const std::int32_t excess = polarity == Ad7147::Polarity::kPositive ? above : -above;
    if (std::abs(excess) > kThird) outside_ = static_cast<std::uint16_t>(outside_ | 1U << t);
    if (std::abs(excess) <= limit) continue;
    const std::uint8_t offset = better(offsets_[t], excess, !ad7147::in_range(results[t]));
    changed = changed || offset != offsets_[t];
    offsets_[t] = offset;
  }
  return ++rounds_ < kMaxRounds && changed;
}

}  // namespace triskin::fw
