// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <cstdint>
#include <span>

#include "triskin/core/bytes.hpp"
#include "triskin/core/status.hpp"
#include "triskin/layout/module.hpp"
#include "triskin/wire/identifiers.hpp"
#include "triskin/wire/stream_lease.hpp"

namespace triskin::wire {

/// What became of one module's samples. A sample whose number the leases ask for was left unread, was dropped, was
/// sent, or waits: the four counts together grow by one with each.
struct RowAccount {
  static constexpr std::size_t kBytes = 17;
  /// It is the latest sample's number; all samples that were due since sampling began are counted.
  std::uint32_t number = 0;
  std::uint32_t unread = 0;  ///< It counts samples that the controller did not read in time.
  /// It counts samples that were read but found no room, because the bus is slower than the stream.
  std::uint32_t dropped = 0;
  std::uint32_t sent = 0;    ///< It counts samples that were handed to the bus.
  std::uint8_t waiting = 0;  ///< It counts samples that wait for the bus now.
  bool operator==(const RowAccount&) const = default;
};

/// FD0C: account of the stream over the port that asks.
struct StreamAccount {
  static constexpr std::uint16_t kId = did::kStreamAccount;
  static constexpr std::size_t kHeadBytes = 10, kLeaseBytes = 4, kMinBytes = kHeadBytes,
                               kMaxBytes =
                                   kHeadBytes + kLeaseBytes * kMaxLeases + RowAccount::kBytes * layout::kMaxModules;
  /// Sampling restarted so often since power-up, modulo 256, and numbers began at 1 each time.
  std::uint8_t starts = 0;
  std::uint64_t time_us = 0;  ///< It is the controller's clock when it answered.
  std::uint8_t readers = 0;   ///< So many leases last, 0 … kMaxLeases.
  std::array<std::uint32_t, kMaxLeases> reader{};
  std::uint8_t count = 0;  ///< It counts the modules of the table, 0 … kMaxModules.
  std::array<RowAccount, layout::kMaxModules> modules{};

  /// Accounts of the modules in the table, by row.
  [[nodiscard]] constexpr std::span<const RowAccount> rows() const { return std::span(modules).first(count); }
  /// True when the reader has a lease.
  [[nodiscard]] constexpr bool serves(std::uint32_t number) const {
    for (const std::uint32_t r : std::span(reader).first(readers)) {
      if (r == number) return true;
    }
    return false;
  }
  /// Appends the value as it stands on the wire.
  constexpr void encode(ByteWriter& out) const {
    out.u8(starts);
    out.le64(time_us);
    out.u8(readers);
    for (const std::uint32_t r : std::span(reader).first(readers)) out.le32(r);
    for (const RowAccount& m : rows()) {
      for (const std::uint32_t v : {m.number, m.unread, m.dropped, m.sent}) out.le32(v);
      out.u8(m.waiting);
    }
  }
  /// Errors: kBadLength (no whole number of modules, or too many), kOutOfRange (more leases than there can be).
  [[nodiscard]] static constexpr Result<StreamAccount> decode(Bytes bytes) {
    if (bytes.size() < kMinBytes) return std::unexpected(Status::kBadLength);
    ByteReader r(bytes);
    StreamAccount a;
    a.starts = r.u8();
    a.time_us = r.le64();
    a.readers = r.u8();
    if (a.readers > kMaxLeases) return std::unexpected(Status::kOutOfRange);
    for (std::uint32_t& reader : std::span(a.reader).first(a.readers)) reader = r.le32();
    const std::size_t left = r.rest().size(), rows = left / RowAccount::kBytes;
    if (!r.ok() || left % RowAccount::kBytes != 0 || rows > layout::kMaxModules)
      return std::unexpected(Status::kBadLength);
    a.count = static_cast<std::uint8_t>(rows);
    for (RowAccount& m : std::span(a.modules).first(a.count)) {
      for (std::uint32_t* v : {&m.number, &m.unread, &m.dropped, &m.sent}) *v = r.le32();
      m.waiting = r.u8();
    }
    return a;
  }
  bool operator==(const StreamAccount&) const = default;
};
static_assert(kLengthsAsInTable<StreamAccount>);

}  // namespace triskin::wire
