// SPDX-License-Identifier: Apache-2.0
#include "triskin/logic/sequence_clock.hpp"

#include <algorithm>

namespace triskin::fw {

void SequenceClock::start(std::uint64_t at_us, std::uint32_t nominal_us) {
  const std::uint64_t nominal = std::uint64_t{nominal_us} << kFraction;
  least_ = nominal * (100 - kTolerance_percent) / 100;
  most_ = nominal * (100 + kTolerance_percent) / 100;
  period_ = nominal;
  stage_us_ = nominal_us / 12;
  locked_ = false;
  since_look_ = 0;
  look_every_ = 1;
  agreements_ = 0;
  restart(at_us);
}

void SequenceClock::restart(std::uint64_t at_us) {
  start_ = (at_us - kLate_us) << kFraction;
  end_ = start_ + period_;
  sequences_ = 1;
  since_look_ = 0;
  contradictions_ = 0;
}

std::uint64_t SequenceClock::read_us() const {
  constexpr std::uint64_t kEarly_us = 360;
  if (locked_) return end_us() - kEarly_us;
  return end_us() + (stage_us_ - kFirstResult_us) / 2 - kLastResult_us / 2;  // the middle of the window
}

std::uint64_t SequenceClock::look_us() const {
  const std::int64_t offset_us = !locked_ ? 0 : before_ ? -kFence_us : kFence_us;
  return end_us() + static_cast<std::uint64_t>(offset_us) - kStatusRead_us;
}

void SequenceClock::looked(std::uint64_t at_us, bool ended) {
  since_look_ = 0;
  if (locked_) fence(at_us, ended);
  else narrow(at_us, ended);
}

// The start is known: end n lies n periods after it.
void SequenceClock::narrow(std::uint64_t at_us, bool ended) {
  const std::uint64_t since = (at_us << kFraction) - start_, slack = kSlack_us << kFraction;
  if (ended) most_ = std::min(most_, (since + slack) / sequences_);
  else least_ = std::max(least_, (since - slack) / sequences_);
  if (least_ > most_) {  // the slack was too small: both have moved past each other
    const std::uint64_t middle = (least_ + most_) / 2;
    least_ = middle - slack / sequences_;
    most_ = middle + slack / sequences_;
  }
  period_ = (least_ + most_) / 2;
  end_ = start_ + sequences_ * period_;
  locked_ = sequences_ >= kLockAfter;
}

void SequenceClock::fence(std::uint64_t at_us, bool ended) {
  const std::uint64_t at = at_us << kFraction;
  if (ended == (at >= end_)) {
    before_ = !before_;
    contradictions_ = 0;
    if (++agreements_ < kAgreements) return;
    agreements_ = 0;
    look_every_ = std::min(2 * look_every_, kMostSeldom);
    return;
  }
  ++contradictions_;
  agreements_ = 0;
  constexpr std::uint64_t kStep = std::uint64_t{20} << kFraction;
  const std::uint64_t corrected = ended ? at - kStep : at + kStep;
  const auto error = static_cast<std::int64_t>(corrected) - static_cast<std::int64_t>(end_);
  constexpr std::int64_t kMost = 4 << kFraction;
  period_ = static_cast<std::uint64_t>(static_cast<std::int64_t>(period_) + std::clamp(error / (4 * static_cast<std::int64_t>(look_every_)), -kMost, kMost));
  end_ = corrected;
  look_every_ = std::max(look_every_ / 2, std::uint32_t{1});
}

void SequenceClock::next(std::uint32_t count) {
  end_ += count * period_;
  sequences_ += count;
  since_look_ += count;
}

}  // namespace triskin::fw
