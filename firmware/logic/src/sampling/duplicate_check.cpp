// SPDX-License-Identifier: Apache-2.0
#include "triskin/logic/sampling/duplicate_check.hpp"

namespace triskin::fw {

DuplicateCheck::Verdict DuplicateCheck::compare(const ad7147::Results& other, const ad7147::Results& used) {
  std::int64_t deficit = 0;
  int compared = 0;
  for (std::size_t t = 0; t < used.size(); ++t) {
    if (!ad7147::in_range(used[t]) || !ad7147::in_range(other[t])) continue;
    deficit += 2 * static_cast<std::int64_t>(ad7147::kMidScale) - used[t] - other[t];
    ++compared;
  }
  if (deficit <= static_cast<std::int64_t>(kMinDeficit) * compared) {
    suspicions_ = 0;
    return Verdict::kSingle;
  }
  if (++suspicions_ < kMinSuspicions) return Verdict::kSuspected;
  suspicions_ = kMinSuspicions - 1;
  return Verdict::kDuplicate;
}

}  // namespace triskin::fw
