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

/// Tells what happened to the samples of one module. A sample that the leases ask for was left unread, was dropped, was
/// sent, or is waiting, so the sum of the four counters grows by one with each such sample.
struct RowAccount {
  static constexpr std::size_t kBytes = 17;
  /// The number of the latest sample includes all samples that were due since sampling began.
  std::uint32_t number = 0;
  std::uint32_t unread = 0;  ///< The controller did not read these samples in time.
  /// These samples were read but found no room, because the bus is slower than the stream.
  std::uint32_t dropped = 0;
  std::uint32_t sent = 0;    ///< These samples were handed to the bus.
  std::uint8_t waiting = 0;  ///< These samples are waiting for the bus now.
  bool operator==(const RowAccount&) const = default;
};

/// Identifier FD0C carries the account of the stream for the port from which the request came.
struct StreamAccount {
  static constexpr std::uint16_t kId = did::kStreamAccount;
  static constexpr std::size_t kHeadBytes = 10, kLeaseBytes = 4, kMinBytes = kHeadBytes,
                               kMaxBytes =
                                   kHeadBytes + kLeaseBytes * kMaxLeases + RowAccount::kBytes * layout::kMaxModules;
  /// Sampling has restarted this often since power-up, modulo 256; each time the numbers began at 1 again.
  std::uint8_t starts = 0;
  std::uint64_t time_us = 0;  ///< The controller's clock was read for this answer.
  std::uint8_t readers = 0;   ///< This many leases are active, 0 … kMaxLeases.
  std::array<std::uint32_t, kMaxLeases> reader{};
  std::uint8_t count = 0;  ///< The table has 0 … kMaxModules modules.
  std::array<RowAccount, layout::kMaxModules> modules{};

  /// Returns the accounts of the modules, indexed by the row of the table.
  [[nodiscard]] constexpr std::span<const RowAccount> rows() const { return std::span(modules).first(count); }
  /// Returns true when the reader has a lease.
  [[nodiscard]] constexpr bool serves(std::uint32_t number) const {
    for (const std::uint32_t r : std::span(reader).first(readers)) {
      if (r == number) return true;
    }
    return false;
  }
  /// Appends the value in its wire format (docs/protocol.md). `out` is no longer ok() if it lacks room.
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
  /// Decodes the wire format. Errors: kBadLength (a partial module, or too many), kOutOfRange (more leases than a
  /// controller keeps).
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
