// SPDX-License-Identifier: Apache-2.0
#include "triskin/logic/sampling/compensation.hpp"

#include <algorithm>

namespace triskin::fw {
namespace {

constexpr bool is_pad(std::size_t taxel) {
  return !layout::measures_pressure(taxel);
}

constexpr std::int64_t rounded(std::int64_t value, unsigned bits) {
  return (value + (std::int64_t{1} << (bits - 1))) >> bits;
}

}  // namespace

// Returns twice the mean change of the valid pads: the sum of both, or one of them doubled.
std::int64_t Compensation::pads_change(const Taxels& raw, std::uint16_t valid) const {
  std::int64_t sum = 0;
  int count = 0;
  for (std::size_t k = 0; k < kPads.size(); ++k) {
    if ((valid & known_ & 1U << kPads[k]) == 0) continue;
    sum += static_cast<std::int64_t>(raw[kPads[k]]) - pad_baseline_[k];
    ++count;
  }
  return count == 1 ? 2 * sum : sum;
}

void Compensation::add(const Taxels& raw, std::uint16_t valid) {
  if (!started_) known_ = 0;
  started_ = true;
  for (std::size_t k = 0; k < kPads.size(); ++k) {
    if ((valid & ~known_ & 1U << kPads[k]) != 0) pad_baseline_[k] = raw[kPads[k]];
  }
  const auto fresh = static_cast<std::uint16_t>(valid & ~known_);
  known_ = static_cast<std::uint16_t>(known_ | fresh);
  const std::int64_t pads = pads_change(raw, valid);
  for (std::size_t t = 0; t < raw.size(); ++t) {
    if ((valid & 1U << t) == 0) continue;
    // The pads' change is doubled, so the shift has one more bit.
    const std::int64_t thermal = is_pad(t) ? 0 : gain_[t] * pads * (1 << (kFraction - kGainBits - 1));
    const std::int64_t steady = (static_cast<std::int64_t>(raw[t]) << kFraction) - thermal;
    if ((fresh & 1U << t) != 0) baseline_[t] = steady;
    const std::int64_t change = steady - baseline_[t];
    output_[t] = static_cast<std::uint16_t>(std::clamp<std::int64_t>(kRest + rounded(change, kFraction), 0, 0xFFFF));
    const bool touched =
        change >= (std::int64_t{kTouch} << kFraction) || change <= -(std::int64_t{kTouch} << kFraction);
    if (!touched && !is_pad(t)) baseline_[t] += rounded(change, kFollow);
  }
}

}  // namespace triskin::fw
