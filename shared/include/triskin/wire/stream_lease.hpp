// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>

#include "triskin/core/bytes.hpp"
#include "triskin/core/status.hpp"
#include "triskin/wire/can_frame.hpp"

/// Tells who reads the full stream, and for how long (docs/protocol.md, "Leases").
///
/// A reader sends a lease to all controllers and renews it before it ends. A controller streams as long as at least one
/// lease is valid; when one reader's lease ends, the others are not affected.
namespace triskin::wire {

inline constexpr std::uint32_t kLeaseId = 0x18E2FFF1;
/// A controller keeps this many leases for each of its ports.
inline constexpr std::size_t kMaxLeases = 8;

struct StreamLease {
  static constexpr std::uint8_t kBytes = 8;
  std::uint32_t reader = 0;     ///< The reader draws a random number that is never 0.
  std::uint8_t lasts_10ms = 0;  ///< The lease lasts this long after the frame; 0 ends it now.
  std::uint8_t every = 1;       ///< The reader gets the samples whose number is a multiple of this, 1 … 255.
  /// On average, two samples of a module are at least this far apart; 0 disables the limit.
  std::uint16_t pace_100us = 0;
  bool operator==(const StreamLease&) const = default;
};

/// Encodes a lease as a frame.
[[nodiscard]] constexpr CanFrame encode_lease(const StreamLease& l) {
  CanFrame f;
  f.id = kLeaseId;
  f.extended = true;
  f.size = StreamLease::kBytes;
  ByteWriter w(f.data);
  w.le32(l.reader);
  w.u8(l.lasts_10ms);
  w.u8(l.every);
  w.le16(l.pace_100us);
  return f;
}

/// Decodes a lease. Errors: kBadLength, kOutOfRange (another identifier, reader 0, `every` 0).
[[nodiscard]] constexpr Result<StreamLease> decode_lease(const CanFrame& f) {
  if (!f.extended || f.id != kLeaseId) return std::unexpected(Status::kOutOfRange);
  if (f.size != StreamLease::kBytes) return std::unexpected(Status::kBadLength);
  ByteReader r(f.payload());
  StreamLease l;
  l.reader = r.le32();
  l.lasts_10ms = r.u8();
  l.every = r.u8();
  l.pace_100us = r.le16();
  if (l.reader == 0 || l.every == 0) return std::unexpected(Status::kOutOfRange);
  return l;
}

}  // namespace triskin::wire
