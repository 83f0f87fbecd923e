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

/// Who reads the full stream over a port, and until when.
class StreamLeases {
 public:
  /// Begins, renews or ends the lease of a reader. A ninth reader gets none: the account shows it.
  void renew(const wire::StreamLease& lease, std::uint64_t now_us);
  /// Ends the leases whose time has come.
  void expire(std::uint64_t now_us);
  /// True while a lease lasts.
  [[nodiscard]] bool any() const { return count_ > 0; }
  /// True when a lease asks for the sample with this number.
  [[nodiscard]] bool want(std::uint32_t number) const;
  /// Least time between two samples of a module, µs: the shortest that a lease names; 0: none does.
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

/// The full stream over one port: what its readers are to get waits here for room in the port, and each sample is
/// counted. A row has at most kPerRow samples waiting, and rows take turns: when the bus is too slow each module gets
/// its share.
class FullStream {
 public:
  static constexpr std::size_t kPerRow = 3;  ///< samples
  static constexpr std::size_t kCapacity = kPerRow * layout::kMaxModules;

  /// Sampling begins anew: numbers start at 1. Leases stay; what waits is dropped.
  void restart(std::uint8_t starts);
  /// The rows from `row` on mean other modules now: their numbers start at 1, what waits counts in dropped() alone.
  void forget_from(std::size_t row);
  /// A lease came.
  void renew(const wire::StreamLease& lease, std::uint64_t now_us) { leases_.renew(lease, now_us); }
  /// Streams without a lease (FD05), or no longer.
  void hold(bool on);
  /// True while a sample may be wanted.
  [[nodiscard]] bool active() const { return held_ || leases_.any(); }
  /// Ends leases whose time has come. Without a reader nothing waits any more.
  void tick(std::uint64_t now_us);
  /// A sample of the module in `row` stands, or could not be read. `rows`: modules of the table. The frame waits when a
  /// reader wants it and there is room; `pausing`: it is dropped in any case.
  void add(const wire::TaxelFrame& sample, std::size_t rows, bool pausing);

  /// True when the next frame may be sent now.
  [[nodiscard]] bool due(std::uint64_t now_us) const { return size_ > 0 && now_us >= next_us_; }
  /// When it may be sent; max: nothing waits.
  [[nodiscard]] std::uint64_t next_event_us() const { return size_ > 0 ? next_us_ : UINT64_MAX; }
  /// The sample that waits longest of the row whose turn it is. Requires due().
  [[nodiscard]] wire::CanFrame front() const { return wire::encode_full(waiting_[place(next_row(), 0)]); }
  /// Takes it out: it was sent.
  void pop(std::uint64_t now_us);
  /// Samples that found no room since power-up.
  [[nodiscard]] std::uint32_t dropped() const { return dropped_; }
  /// Account of the rows 0 … `rows` − 1.
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
  std::array<wire::TaxelFrame, kCapacity> waiting_{};  // Holds a ring of kPerRow for each row.
  std::array<std::uint8_t, layout::kMaxModules> first_{};
  std::size_t size_ = 0;
  std::size_t turn_ = layout::kMaxModules - 1;  // Row that sent last.
  std::array<wire::RowAccount, layout::kMaxModules> rows_{};
  std::uint32_t dropped_ = 0;
  std::uint32_t gap_us_ = 0;  // Mean minimum time between two frames.
  std::uint64_t next_us_ = 0;
  std::uint8_t starts_ = 0;
};

}  // namespace triskin::fw
