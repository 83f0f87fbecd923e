// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>

#include "triskin/core/bytes.hpp"
#include "triskin/wire/checked_enum.hpp"
#include "triskin/wire/identifiers.hpp"

namespace triskin::wire {

/// FD04: counts since power-up; each begins anew after 2^32 − 1.
struct Statistics {
  static constexpr std::uint16_t kId = did::kStatistics;
  static constexpr std::size_t kMinBytes = 16, kMaxBytes = 16;
  std::uint32_t sequences = 0;    ///< It counts the nominal sequences of the converters.
  std::uint32_t bus_errors = 0;   ///< It counts transfers without acknowledgement on all lines.
  std::uint32_t recoveries = 0;   ///< It counts how often a line that was held low could be freed.
  std::uint32_t lost_frames = 0;  ///< Stream frames are lost when the bus is slower than the stream.

  /// Appends the value as it stands on the wire.
  constexpr void encode(ByteWriter& out) const {
    for (const std::uint32_t v : {sequences, bus_errors, recoveries, lost_frames}) out.le32(v);
  }
  /// Value of these bytes.
  /// Error: kBadLength.
  [[nodiscard]] static constexpr Result<Statistics> decode(Bytes bytes) {
    if (bytes.size() != kMaxBytes) return std::unexpected(Status::kBadLength);
    ByteReader r(bytes);
    Statistics s;
    for (std::uint32_t* v : {&s.sequences, &s.bus_errors, &s.recoveries, &s.lost_frames}) *v = r.le32();
    return s;
  }
  bool operator==(const Statistics&) const = default;
};
static_assert(kLengthsAsInTable<Statistics>);

}  // namespace triskin::wire
