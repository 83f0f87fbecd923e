// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstdint>

#include "triskin/wire/stream_account.hpp"
#include "triskin/wire/taxel_frames.hpp"

namespace triskin::session {

/// The samples that were due are counted here. Every sample is either received or lost at one of four points.
struct SampleCounts {
  std::uint64_t expected = 0;
  std::uint64_t received = 0;
  std::uint64_t with_data = 0;   ///< Only received samples with at least one valid taxel count here.
  std::uint64_t unread = 0;      ///< The controller did not read these samples in time.
  std::uint64_t dropped = 0;     ///< These samples found no room on the bus.
  std::uint64_t on_the_way = 0;  ///< These samples were lost after they had been sent.
  /// The controller was away while these were due, so their number is computed from the rate.
  std::uint64_t silent = 0;
  /// Counts the samples that were due and did not arrive: expected − received.
  [[nodiscard]] std::uint64_t lost() const { return unread + dropped + on_the_way + silent; }
  /// Adds the counts of another module or period.
  SampleCounts& operator+=(const SampleCounts& other);
  bool operator==(const SampleCounts&) const = default;
};

/// Counts the samples of one module during a reader's lease. It uses the controller's sample numbers, so that samples
/// that never arrived count as well; the numbers' 32 bits may wrap. Feed it the samples in the order of arrival, and
/// the controller's account at the beginning and at the end. Cost: constant. Threads: one.
class SampleAccount {
 public:
  SampleAccount() = default;
  /// Expects the samples whose number is a multiple of `every` (1 … 255). `interval_us` is the nominal time between
  /// two sample numbers.
  SampleAccount(int every, std::uint64_t interval_us) : every_(every), interval_us_(interval_us) {}

  /// Starts the lease after the sample `account.number`. `now_us` is the clock of the link.
  void begin(std::uint8_t starts, const wire::RowAccount& account, std::uint64_t now_us);
  /// Counts a sample that arrived at `now_us`. Returns false, and counts nothing, if the sample is outside the lease:
  /// before its beginning, after its end, not a multiple, or a duplicate.
  bool add(const wire::TaxelFrame& sample, std::uint64_t now_us);
  /// Ends the lease with the sample `account.number`; samples up to it may still arrive.
  void end(std::uint8_t starts, const wire::RowAccount& account, std::uint64_t now_us);
  /// Ends the lease without an account from the controller; everything that was due since its last sample counts as
  /// lost.
  void end_silent(std::uint64_t now_us);
  /// Returns true if all samples up to the end of the account have arrived.
  [[nodiscard]] bool complete() const;
  /// Returns the counts up to the latest sample that arrived; after the end, those of the whole lease.
  [[nodiscard]] SampleCounts counts() const;
  /// Returns true after begin().
  [[nodiscard]] bool started() const { return started_; }

 private:
  struct Counters {
    std::uint64_t number = 0;
    std::uint32_t unread = 0, dropped = 0;
  };
  [[nodiscard]] std::uint64_t widen(std::uint32_t number) const;
  bool count(const wire::TaxelFrame& sample, std::uint64_t number, std::uint64_t now_us);
  void restart(std::uint8_t starts, std::uint32_t number, std::uint64_t now_us);
  [[nodiscard]] SampleCounts since_start() const;
  [[nodiscard]] std::uint64_t multiples(std::uint64_t after, std::uint64_t up_to) const;

  int every_ = 1;
  std::uint64_t interval_us_ = 0;
  bool started_ = false, ended_ = false;
  std::uint8_t starts_ = 0;
  Counters first_, last_;
  // The number of the latest sample continues past 32 bits when the controller's number wraps.
  std::uint64_t newest_ = 0;
  std::uint64_t device_time_us_ = 0, heard_us_ = 0;
  std::uint64_t received_ = 0, with_data_ = 0;  // Both counts start at the controller's last start.
  SampleCounts before_;                         // These counts come from earlier starts of the controller.
};

}  // namespace triskin::session
