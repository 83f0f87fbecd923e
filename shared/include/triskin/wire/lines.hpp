// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <cstdint>

#include "triskin/core/bytes.hpp"
#include "triskin/layout/module.hpp"
#include "triskin/wire/checked_enum.hpp"
#include "triskin/wire/identifiers.hpp"

/// Identifier FD06 and routine 0201 report on the I²C lines of a controller; see docs/protocol.md.
namespace triskin::wire {

struct LineState {
  bool stuck = false;            ///< True means that a device holds the line low.
  std::uint32_t recoveries = 0;  ///< Recoveries of this line are counted from power-up.
  bool operator==(const LineState&) const = default;
};

/// Identifier FD06 carries this value.
struct LineStates {
  static constexpr std::uint16_t kId = did::kLineStates;
  static constexpr std::size_t kMaxBytes = 5 * layout::kLines, kMinBytes = kMaxBytes;
  std::array<LineState, layout::kLines> lines{};

  /// Appends the value in its wire format (docs/protocol.md). `out` is no longer ok() if it lacks room.
  constexpr void encode(ByteWriter& out) const {
    for (const LineState& l : lines) {
      out.u8(l.stuck ? 1 : 0);
      out.le32(l.recoveries);
    }
  }
  /// Decodes the wire format. Errors: kBadLength, kOutOfRange.
  [[nodiscard]] static constexpr Result<LineStates> decode(Bytes bytes) {
    if (bytes.size() != kMaxBytes) return std::unexpected(Status::kBadLength);
    ByteReader r(bytes);
    LineStates s;
    for (LineState& l : s.lines) {
      const auto stuck = checked_bool(r.u8());
      if (!stuck) return std::unexpected(stuck.error());
      l = {*stuck, r.le32()};
    }
    return s;
  }
  bool operator==(const LineStates&) const = default;
};
static_assert(kLengthsAsInTable<LineStates>);

/// A discovery finds this on one line.
struct LineReport {
  bool stuck = false;        ///< The line was held low, so no chip could be asked.
  std::uint8_t answers = 0;  ///< Bit a says that a chip answers at cdc_address(a).
  /// Bit a says that the chip has another device id; `answers` contains this bit too.
  std::uint8_t wrong_id = 0;
  bool operator==(const LineReport&) const = default;
};

/// Routine 0201 returns this result.
struct Discovery {
  static constexpr std::uint16_t kId = routine::kDiscover;
  static constexpr std::size_t kMaxBytes = 1 + 3 * layout::kLines, kMinBytes = kMaxBytes;
  bool done = false;
  std::array<LineReport, layout::kLines> lines{};

  /// Appends the value in its wire format (docs/protocol.md). `out` is no longer ok() if it lacks room.
  constexpr void encode(ByteWriter& out) const {
    out.u8(done ? 1 : 0);
    for (const LineReport& l : lines) {
      out.u8(l.stuck ? 1 : 0);
      out.u8(l.answers);
      out.u8(l.wrong_id);
    }
  }
  /// Decodes the wire format. Errors: kBadLength, kOutOfRange (an address that a line does not have; a wrong id where
  /// no chip answers).
  [[nodiscard]] static constexpr Result<Discovery> decode(Bytes bytes) {
    if (bytes.size() != kMaxBytes) return std::unexpected(Status::kBadLength);
    ByteReader r(bytes);
    const auto done = checked_bool(r.u8());
    if (!done) return std::unexpected(done.error());
    Discovery d{*done, {}};
    for (LineReport& l : d.lines) {
      const auto stuck = checked_bool(r.u8());
      if (!stuck) return std::unexpected(stuck.error());
      l.stuck = *stuck;
      l.answers = r.u8();
      l.wrong_id = r.u8();
      if (l.answers >> layout::kAddressesPerLine != 0 || (l.wrong_id & ~l.answers) != 0)
        return std::unexpected(Status::kOutOfRange);
    }
    return d;
  }
  bool operator==(const Discovery&) const = default;
};
static_assert(kResultAsInTable<Discovery>);

}  // namespace triskin::wire
