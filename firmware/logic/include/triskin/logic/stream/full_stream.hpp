// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <cstdint>

#include "triskin/layout/patch_image.hpp"
#include "triskin/logic/sampling/table_row.hpp"
#include "triskin/wire/stream_account.hpp"
#include "triskin/wire/stream_lease.hpp"
#include "triskin/wire/taxel_frames.hpp"

namespace triskin::fw {

/// Tells who reads the full stream over a port, and until when.
class StreamLeases {
 public:
  /// Starts, renews or ends the lease of a reader. A ninth reader gets none, which the account shows.
  void renew(const wire::StreamLease& lease, std::uint64_t now_us);
  /// Ends the leases that have expired.
  void expire(std::uint64_t now_us);
  /// Returns true while at least one lease is valid.
  [[nodiscard]] bool any() const { return count_ > 0; }
  /// Returns true when a lease asks for the sample with this number.
  [[nodiscard]] bool want(std::uint32_t number) const;
  /// Returns the least time between two samples of a module in µs: the shortest that a lease names, or 0 if none does.
  [[nodiscard]] std::uint32_t pace_us() const;
  /// Writes the readers into an account.
  void report(wire::StreamAccount& account) const;

 private:
  struct Lease {
    wire::StreamLease what;
    std::uint64_t until_us = 0;
  };
  std::array<Lease, wire::kMaxLeases> leases_{};
  std::size_t count_ = 0;
};

/// In the full stream over one port, samples wait here for room in the port, and each one is counted. A row has at most
/// kPerRow samples waiting, and rows take turns, so that each module gets its share when the bus is too slow.
class FullStream {
 public:
  static constexpr std::size_t kPerRow = 3;  ///< Each row can have this many samples waiting.
  static constexpr std::size_t kCapacity = kPerRow * layout::kMaxModules;

  /// Restarts the numbers at 1 with the sampling. Leases stay; waiting samples are dropped.
  void restart(std::uint8_t starts);
  /// Notes that the rows from `row` on mean other modules: their numbers restart at 1, and waiting samples count only
  /// in dropped().
  void forget_from(std::size_t row);
  /// Starts, renews or ends the lease of a reader.
  void renew(const wire::StreamLease& lease, std::uint64_t now_us) { leases_.renew(lease, now_us); }
  /// Starts or ends streaming without a lease (FD05).
  void hold(bool on);
  /// Returns true while a sample may be wanted.
  [[nodiscard]] bool active() const { return held_ || leases_.any(); }
  /// Ends expired leases. Without a reader, waiting samples are dropped.
  void tick(std::uint64_t now_us);
  /// Handles a sample of the module in `row`, which may be invalid. `rows` counts the modules of the table. The frame
  /// waits if a reader wants it and there is room; with `pausing` it is dropped in any case.
  void add(const wire::TaxelFrame& sample, std::size_t rows, bool pausing);

  /// Returns true when the next frame may be sent now.
  [[nodiscard]] bool due(std::uint64_t now_us) const { return size_ > 0 && now_us >= next_us_; }
  /// Returns when it may be sent; the largest value if nothing waits.
  [[nodiscard]] std::uint64_t next_event_us() const { return size_ > 0 ? next_us_ : UINT64_MAX; }
  /// Returns the oldest sample of the row whose turn it is. Requires due().
  [[nodiscard]] wire::CanFrame front() const { return wire::encode_full(waiting_[place(next_row(), 0)]); }
  /// Removes that sample after it was sent.
  void pop(std::uint64_t now_us);
  /// Counts the samples that found no room since power-up.
  [[nodiscard]] std::uint32_t dropped() const { return dropped_; }
  /// Returns the account of the rows 0 … `rows` − 1.
  [[nodiscard]] wire::StreamAccount account(std::size_t rows, std::uint64_t now_us) const;

 private:
  void count_unread(wire::RowAccount& row, std::uint32_t next_number) const;
  [[nodiscard]] bool want(std::uint32_t number) const { return held_ || leases_.want(number); }
  void drop_waiting();
  [[nodiscard]] std::size_t place(std::size_t row, std::size_t k) const {
    return row * kPerRow + (first_[row] + k) % kPerRow;
  }
  [[nodiscard]] std::size_t next_row() const;

  StreamLeases leases_;
  bool held_ = false;
  std::array<wire::TaxelFrame, kCapacity> waiting_{};  // Each row has a ring of kPerRow frames.
  std::array<std::uint8_t, layout::kMaxModules> first_{};
  std::size_t size_ = 0;
  std::size_t turn_ = layout::kMaxModules - 1;  // The next turn begins after the row that sent last.
  std::array<wire::RowAccount, layout::kMaxModules> rows_{};
  std::uint32_t dropped_ = 0;
  std::uint32_t gap_us_ = 0;  // On average, two frames are at least this far apart.
  std::uint64_t next_us_ = 0;
  std::uint8_t starts_ = 0;
};

}  // namespace triskin::fw
