// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>

#include "triskin/core/bytes.hpp"
#include "triskin/wire/checked_enum.hpp"
#include "triskin/wire/identifiers.hpp"

namespace triskin::wire {

/// Identifier FD04 carries these counters, which start at power-up and wrap around after 2^32 − 1.
struct Statistics {
  static constexpr std::uint16_t kId = did::kStatistics;
  static constexpr std::size_t kMinBytes = 16, kMaxBytes = 16;
  std::uint32_t sequences = 0;    ///< The nominal sequences of the converters are counted here.
  std::uint32_t bus_errors = 0;   ///< The counter includes transfers without acknowledgement on all lines.
  std::uint32_t recoveries = 0;   ///< The counter shows how often a line that was held low could be freed.
  std::uint32_t lost_frames = 0;  ///< Stream frames are lost when the bus is slower than the stream.

  /// Appends the value in its wire format (docs/protocol.md). `out` is no longer ok() if it lacks room.
  constexpr void encode(ByteWriter& out) const {
    for (const std::uint32_t v : {sequences, bus_errors, recoveries, lost_frames}) out.le32(v);
  }
  /// Decodes the wire format. Error: kBadLength.
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
