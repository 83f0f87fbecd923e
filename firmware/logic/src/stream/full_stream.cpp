// SPDX-License-Identifier: Apache-2.0
#include "triskin/logic/stream/full_stream.hpp"

#include <algorithm>

namespace triskin::fw {

void StreamLeases::renew(const wire::StreamLease& lease, std::uint64_t now_us) {
  expire(now_us);
  const auto end = leases_.begin() + static_cast<std::ptrdiff_t>(count_);
  const auto mine = std::find_if(leases_.begin(), end, [&](const Lease& l) { return l.what.reader == lease.reader; });
  if (mine == end && (lease.lasts_10ms == 0 || count_ == leases_.size())) return;
  if (mine == end) ++count_;
  *mine = {lease, now_us + std::uint64_t{lease.lasts_10ms} * 10'000};
  expire(now_us);
}

void StreamLeases::expire(std::uint64_t now_us) {
  const auto end = leases_.begin() + static_cast<std::ptrdiff_t>(count_);
  const auto kept = std::remove_if(leases_.begin(), end, [&](const Lease& l) { return now_us >= l.until_us; });
  count_ = static_cast<std::size_t>(kept - leases_.begin());
}

bool StreamLeases::want(std::uint32_t number) const {
  return std::any_of(leases_.begin(), leases_.begin() + static_cast<std::ptrdiff_t>(count_),
                     [&](const Lease& l) { return number % l.what.every == 0; });
}

std::uint32_t StreamLeases::pace_us() const {
  std::uint32_t pace = 0;
  for (std::size_t k = 0; k < count_; ++k) {
    const std::uint32_t wanted = std::uint32_t{leases_[k].what.pace_100us} * 100;
    if (wanted != 0) pace = pace == 0 ? wanted : std::min(pace, wanted);
  }
  return pace;
}

void StreamLeases::report(wire::StreamAccount& account) const {
  account.readers = static_cast<std::uint8_t>(count_);
  for (std::size_t k = 0; k < count_; ++k) account.reader[k] = leases_[k].what.reader;
}

void FullStream::drop_waiting() {
  for (wire::RowAccount& row : rows_) {
    row.dropped += row.waiting;
    dropped_ += row.waiting;
    row.waiting = 0;
  }
  size_ = 0;
}

// If rows were sent in the order of arrival, a row whose samples come just before there is room would get less than one
// whose samples come just after.
std::size_t FullStream::next_row() const {
  std::size_t row = turn_;
  do row = (row + 1) % rows_.size();
  while (rows_[row].waiting == 0 && row != turn_);
  return row;
}

void FullStream::restart(std::uint8_t starts) {
  drop_waiting();
  rows_ = {};
  starts_ = starts;
}

void FullStream::forget_from(std::size_t row) {
  for (; row < rows_.size(); ++row) {
    size_ -= rows_[row].waiting;
    dropped_ += rows_[row].waiting;
    rows_[row] = {};
  }
}

void FullStream::hold(bool on) {
  held_ = on;
  if (!active()) drop_waiting();
}

void FullStream::tick(std::uint64_t now_us) {
  if (!leases_.any()) return;
  leases_.expire(now_us);
  if (!active()) drop_waiting();
}

// Skipped numbers belong to sequences that were not read.
void FullStream::count_unread(wire::RowAccount& row, std::uint32_t next_number) const {
  // This is six minutes of samples; a larger gap means that nobody was reading.
  constexpr std::uint32_t kMaxAtOnce = 10'000;
  if (next_number - row.number > kMaxAtOnce) return;
  for (std::uint32_t n = row.number + 1; n != next_number; ++n) {
    if (want(n)) ++row.unread;
  }
}

void FullStream::add(const wire::TaxelFrame& sample, std::size_t rows, bool pausing) {
  wire::RowAccount& row = rows_[sample.module];
  if (active()) count_unread(row, sample.sample);
  row.number = sample.sample;
  if (!active() || !want(sample.sample)) return;
  if (pausing || row.waiting == kPerRow) {
    ++row.dropped;
    ++dropped_;
    return;
  }
  wire::TaxelFrame& last = waiting_[place(sample.module, row.waiting)];
  last = sample;
  last.dropped = row.dropped;
  last.unread = static_cast<std::uint16_t>(row.unread);
  last.starts = starts_;
  ++row.waiting;
  ++size_;
  gap_us_ = rows == 0 ? 0 : leases_.pace_us() / static_cast<std::uint32_t>(rows);
}

// A few frames may leave together, because the pace applies on average.
void FullStream::pop(std::uint64_t now_us) {
  constexpr std::uint32_t kTogether = 4;
  turn_ = next_row();
  --rows_[turn_].waiting;
  ++rows_[turn_].sent;
  first_[turn_] = static_cast<std::uint8_t>((first_[turn_] + 1) % kPerRow);
  --size_;
  const std::uint64_t burst_us = std::uint64_t{kTogether} * gap_us_;
  next_us_ = std::max(next_us_, now_us > burst_us ? now_us - burst_us : 0) + gap_us_;
}

wire::StreamAccount FullStream::account(std::size_t rows, std::uint64_t now_us) const {
  wire::StreamAccount a;
  a.starts = starts_;
  a.time_us = now_us;
  leases_.report(a);
  a.count = static_cast<std::uint8_t>(rows);
  std::copy_n(rows_.begin(), rows, a.modules.begin());
  return a;
}

}  // namespace triskin::fw
