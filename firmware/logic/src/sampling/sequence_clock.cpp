// SPDX-License-Identifier: Apache-2.0
#include "triskin/logic/sampling/sequence_clock.hpp"

#include <algorithm>

namespace triskin::fw {

void SequenceClock::start(std::uint64_t at_us, std::uint32_t nominal_us, wire::Latching latching,
                          std::uint32_t tolerance_percent) {
  nominal_us_ = nominal_us;
  latching_ = latching;
  const std::uint64_t nominal = std::uint64_t{nominal_us} << kFraction;
  shortest_ = nominal * (100 - tolerance_percent) / 100;
  longest_ = nominal * (100 + tolerance_percent) / 100;
  begin(at_us);
}

void SequenceClock::restart(std::uint64_t at_us) {
  if (contradictions_ >= kMaxContradictions) return start(at_us, nominal_us_, latching_);
  begin(at_us);
}

void SequenceClock::begin(std::uint64_t at_us) {
  const std::uint64_t at = at_us << kFraction;
  anchor_first_ = at - kSlack;
  anchor_last_ = at + kSlack;
  since_anchor_ = 1;
  first_ = anchor_first_ + shortest_;
  last_ = anchor_last_ + longest_;
  contradictions_ = 0;
}

// Returns a bound on the change of the period over so many sequences.
std::uint64_t SequenceClock::wander(std::uint64_t sequences) const {
  const std::uint64_t period = period_us();
  return ((period * kWander_ppm_per_s * (sequences * period) / 1'000'000) << kFraction) / 1'000'000;
}

std::uint32_t SequenceClock::may_pass(std::uint32_t most) const {
  std::uint32_t count = most;
  while (count > 1 && (longest_ - shortest_ + 2 * wander(count)) * count > kMaxGrowth_us << kFraction) count /= 2;
  return count;
}

std::uint64_t SequenceClock::stage_end_us(int stage) const {
  return end_us() - static_cast<std::uint32_t>(period_us()) * static_cast<std::uint32_t>(kStages - 1 - stage) / kStages;
}

std::uint64_t SequenceClock::stage_doubt_us(int stage) const {
  const std::uint64_t by_end = last_ - first_;
  if (since_anchor_ == 0) return by_end >> kFraction;
  const std::uint64_t since_anchor =
      anchor_last_ - anchor_first_ + (longest_ - shortest_) * stages_since_anchor(stage) / kStages;
  return std::min(by_end, since_anchor) >> kFraction;
}

void SequenceClock::refine(std::uint64_t at_us, int stage, bool ended) {
  const auto left = static_cast<std::uint64_t>(kStages - 1 - stage);
  const std::uint64_t at = at_us << kFraction;
  // The stage lies between the anchor and the end, so it bounds the period by itself.
  if (since_anchor_ > 0) {
    const std::uint64_t stages = stages_since_anchor(stage), changed = wander(since_anchor_);
    const std::uint64_t longest = (at + kSlack - anchor_first_) * kStages / stages + changed,
                        shortest = (at - kSlack - anchor_last_) * kStages / stages - changed;
    if (ended && longest >= shortest_) longest_ = std::min(longest_, longest);
    if (!ended && shortest <= longest_) shortest_ = std::max(shortest_, shortest);
  }
  const std::uint64_t latest = at + left * longest_ / kStages + kSlack,
                      earliest = at + left * shortest_ / kStages - kSlack;
  if (ended && latest < first_) return contradict(latest);
  if (!ended && earliest > last_) return contradict(earliest);
  if (ended)
    last_ = std::min(last_, latest);
  else
    first_ = std::max(first_, earliest);
  contradictions_ = 0;
  measure_period();
}

// Replaces what was known: the end is near `end`, and the period has changed.
void SequenceClock::contradict(std::uint64_t end) {
  ++contradictions_;
  first_ = end - 2 * kSlack;
  last_ = end + 2 * kSlack;
  anchor_first_ = first_;
  anchor_last_ = last_;
  since_anchor_ = 0;
  const std::uint64_t wider = longest_ / 1000;
  shortest_ -= wider;
  longest_ += wider;
}

void SequenceClock::measure_period() {
  if (since_anchor_ == 0) return;
  const std::uint64_t changed = wander(since_anchor_);
  const std::uint64_t longest = (last_ - anchor_first_) / since_anchor_ + changed,
                      shortest = (first_ - anchor_last_) / since_anchor_ - changed;
  if (longest < shortest_ || shortest > longest_) {
    shortest_ = shortest;
    longest_ = longest;
    return;
  }
  longest_ = std::min(longest_, longest);
  shortest_ = std::max(shortest_, shortest);
}

void SequenceClock::next(std::uint32_t count) {
  if (since_anchor_ >= kAnchorFor) {
    anchor_first_ = first_;
    anchor_last_ = last_;
    since_anchor_ = 0;
  }
  const std::uint64_t changed = wander(count);
  shortest_ -= changed;
  longest_ += changed;
  first_ += count * shortest_;
  last_ += count * longest_;
  since_anchor_ += count;
}

bool SequenceClock::uncertain() const {
  if (contradictions_ >= kMaxContradictions) return true;
  constexpr std::uint64_t kRoom_us = 600;  // Two bursts nearly fit into this time.
  return last_start_us() < read_us() + kRoom_us && 2 * (longest_ - shortest_ + 2 * kSlack) < last_ - first_;
}

}  // namespace triskin::fw
