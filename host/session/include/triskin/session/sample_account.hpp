// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstdint>

#include "triskin/wire/stream_account.hpp"
#include "triskin/wire/taxel_frames.hpp"

namespace triskin::device {

/// What became of samples that were due. Every one is received or lost in one of four places.
struct SampleCounts {
  std::uint64_t expected = 0;
  std::uint64_t received = 0;
  std::uint64_t with_data = 0;   ///< It counts received samples that have at least one valid taxel.
  std::uint64_t unread = 0;      ///< They were lost because the controller did not read them in time.
  std::uint64_t dropped = 0;     ///< They were lost because they found no room on the bus.
  std::uint64_t on_the_way = 0;  ///< They were lost after they had been sent.
  std::uint64_t silent = 0;      ///< They were lost while the controller was away, and are counted by the rate.
  /// Samples that were due and did not come: expected − received.
  [[nodiscard]] std::uint64_t lost() const { return unread + dropped + on_the_way + silent; }
  /// Adds the counts of another module or time.
  SampleCounts& operator+=(const SampleCounts& other);
  bool operator==(const SampleCounts&) const = default;
};

/// The samples of one module while a reader's lease lasts: arithmetic on the controller's numbers, so that what was
/// never heard counts as well; the numbers' 32 bits may wrap. Fed by samples in the order in which they came, and by
/// the controller's account at the beginning and at the end. Cost: constant. Threads: one.
class SampleAccount {
 public:
  SampleAccount() = default;
  /// Expects the samples whose number is a multiple of `every` (1 … 255). `interval_us`: nominal time between two
  /// sample numbers.
  SampleAccount(int every, std::uint64_t interval_us) : every_(every), interval_us_(interval_us) {}

  /// The lease begins after the sample `account.number`. `now_us`: clock of the link.
  void begin(std::uint8_t starts, const wire::RowAccount& account, std::uint64_t now_us);
  /// A sample came at `now_us`. False: it is none of the lease (before its beginning, after its end, not a multiple, or
  /// it came before), and counts for nothing.
  bool add(const wire::TaxelFrame& sample, std::uint64_t now_us);
  /// The lease ends with the sample `account.number`; samples up to it may still come.
  void end(std::uint8_t starts, const wire::RowAccount& account, std::uint64_t now_us);
  /// The lease ends and the controller does not say how: what was due since it was heard last counts as lost.
  void end_silent(std::uint64_t now_us);
  /// Samples of the account at the end that have not come.
  [[nodiscard]] bool complete() const;
  /// Counts up to the latest sample that came; after the end, of the whole lease.
  [[nodiscard]] SampleCounts counts() const;
  /// True after begin().
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
  std::uint64_t newest_ = 0;  // Number of the latest sample that arrived, counted on over wraps.
  std::uint64_t device_time_us_ = 0, heard_us_ = 0;
  std::uint64_t received_ = 0, with_data_ = 0;  // Counted since the controller's last start.
  SampleCounts before_;                         // Counts from earlier starts of the controller.
};

}  // namespace triskin::device
