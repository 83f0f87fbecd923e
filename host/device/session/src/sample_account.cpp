// SPDX-License-Identifier: GPL-3.0-or-later
#include "triskin/session/sample_account.hpp"

#include <algorithm>

namespace triskin::session {
namespace {

constexpr std::uint64_t kAnswer_us = 1'000'000;  // An answer takes less, even with repeats.
// A controller takes fewer samples in twelve days, and no gap in transmission is that long.
constexpr std::uint64_t kFarAhead = std::uint64_t{1} << 30;

}  // namespace

SampleCounts& SampleCounts::operator+=(const SampleCounts& other) {
  expected += other.expected;
  received += other.received;
  with_data += other.with_data;
  unread += other.unread;
  dropped += other.dropped;
  on_the_way += other.on_the_way;
  silent += other.silent;
  return *this;
}

void SampleAccount::begin(std::uint8_t starts, const wire::RowAccount& account, std::uint64_t now_us) {
  started_ = true;
  starts_ = starts;
  first_ = last_ = {account.number, account.unread, account.dropped};
  newest_ = account.number;
  heard_us_ = now_us;
}

// Extends a number of the controller, whose 32 bits wrap, to the value nearest to the latest one.
std::uint64_t SampleAccount::widen(std::uint32_t number) const {
  const auto ahead = static_cast<std::int32_t>(number - static_cast<std::uint32_t>(newest_));
  const std::int64_t wide = static_cast<std::int64_t>(newest_) + ahead;
  return wide < 0 ? number : static_cast<std::uint64_t>(wide);
}

// Counts multiples as the controller does, on the 32-bit number, so that the sequence starts at 0 again after each
// wrap.
std::uint64_t SampleAccount::multiples(std::uint64_t after, std::uint64_t up_to) const {
  const auto every = static_cast<std::uint64_t>(every_);
  const auto up_to_here = [every](std::uint64_t number) {
    const std::uint64_t of_a_round = 0xFFFF'FFFFU / every + 1;
    return (number >> 32) * of_a_round + (number & 0xFFFF'FFFFU) / every;
  };
  return up_to <= after ? 0 : up_to_here(up_to) - up_to_here(after);
}

// Other readers may ask for samples that this one does not, so the controller's counts are only bounds.
SampleCounts SampleAccount::since_start() const {
  SampleCounts c;
  c.expected = multiples(first_.number, last_.number);
  c.received = received_;
  c.with_data = with_data_;
  std::uint64_t lost = c.expected - std::min(c.expected, received_);
  c.dropped = std::min<std::uint64_t>(lost, last_.dropped - first_.dropped);
  lost -= c.dropped;
  c.unread = std::min<std::uint64_t>(lost, last_.unread - first_.unread);
  c.on_the_way = lost - c.unread;
  return c;
}

SampleCounts SampleAccount::counts() const {
  SampleCounts c = before_;
  if (started_) c += since_start();
  return c;
}

// Numbers start at 1 again. How many samples the controller took before the restart is unknown, so the rate estimates
// it.
void SampleAccount::restart(std::uint8_t starts, std::uint32_t number, std::uint64_t now_us) {
  before_ += since_start();
  const std::uint64_t due = interval_us_ == 0 ? 0 : (now_us - std::min(now_us, heard_us_)) / interval_us_;
  const std::uint64_t away = due > number ? (due - number) / static_cast<std::uint64_t>(every_) : 0;
  before_.expected += away;
  before_.silent += away;
  starts_ = starts;
  // Only samples that were due since then count, not those that it may have taken before.
  first_ = last_ = {number > due + 1 ? number - due - 1 : 0, 0, 0};
  newest_ = first_.number;
  device_time_us_ = 0;
  received_ = with_data_ = 0;
}

bool SampleAccount::add(const wire::TaxelFrame& sample, std::uint64_t now_us) {
  if (!started_) return false;
  const std::uint64_t number = widen(sample.sample);
  const bool jumps = number <= newest_ || number - newest_ > kFarAhead;
  const bool anew = sample.starts != starts_ || (jumps && sample.device_time_us < device_time_us_);
  if (anew && !ended_) restart(sample.starts, sample.sample, now_us);
  if (anew && ended_) return false;
  return count(sample, anew ? sample.sample : number, now_us);
}

bool SampleAccount::count(const wire::TaxelFrame& sample, std::uint64_t number, std::uint64_t now_us) {
  if (number <= newest_ || (ended_ && number > last_.number)) return false;
  if (sample.sample % static_cast<std::uint32_t>(every_) != 0) return false;
  newest_ = number;
  device_time_us_ = sample.device_time_us;
  heard_us_ = now_us;
  ++received_;
  if (sample.valid != 0) ++with_data_;
  if (!ended_) {
    last_.number = number;
    last_.unread += static_cast<std::uint16_t>(sample.unread - last_.unread);
    last_.dropped = sample.dropped;
  }
  return true;
}

void SampleAccount::end(std::uint8_t starts, const wire::RowAccount& account, std::uint64_t now_us) {
  if (!started_ || ended_) return;
  // Samples taken after the answer was composed may have arrived before it, so a number that is slightly lower is no
  // restart.
  const std::uint64_t answer = interval_us_ == 0 ? 1 : 1 + kAnswer_us / interval_us_;
  const bool anew = starts != starts_ || widen(account.number) + answer < last_.number;
  if (anew) restart(starts, account.number, now_us);
  last_ = {std::max(widen(account.number), last_.number), account.unread, account.dropped};
  ended_ = true;
}

void SampleAccount::end_silent(std::uint64_t now_us) {
  if (!started_ || ended_) return;
  restart(starts_, 0, now_us);
  ended_ = true;
}

bool SampleAccount::complete() const {
  const std::uint64_t past_multiple = (last_.number & 0xFFFF'FFFFU) % static_cast<std::uint64_t>(every_);
  return !started_ || last_.number - past_multiple <= newest_;
}

}  // namespace triskin::session
