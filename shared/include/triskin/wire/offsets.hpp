// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <cstdint>
#include <span>

#include "triskin/core/bytes.hpp"
#include "triskin/layout/module.hpp"
#include "triskin/wire/checked_enum.hpp"
#include "triskin/wire/identifiers.hpp"

/// Identifier FD0B has the offsets of the converters, and routine 0206 determines them again; see docs/protocol.md.
namespace triskin::wire {

/// A chip's offsets can come from these sources.
enum class OffsetState : std::uint8_t {
  kNone = 0,       ///< No chip was ever found at this place.
  kSearching = 1,  ///< The controller is still searching for the offsets.
  kKept = 2,       ///< The flash had them, and each taxel still rests where it should.
  kFound = 3,      ///< The controller found them after power-up.
  kOutside = 4,    ///< The search has ended, but a taxel rests outside the middle third of the range.
};
/// Converts a number from the wire. Error: kOutOfRange.
[[nodiscard]] constexpr Result<OffsetState> to_offset_state(std::uint8_t number) {
  return checked_enum(number, OffsetState::kOutside);
}

/// The controller has observed when a converter updates its results.
enum class Latching : std::uint8_t {
  kUnknown = 0,        ///< The order of conversions has not been seen yet.
  kEachStage = 1,      ///< The chip updates each result at the end of its stage.
  kEndOfSequence = 2,  ///< The chip updates all results at the end of the sequence.
};
/// Converts a number from the wire. Error: kOutOfRange.
[[nodiscard]] constexpr Result<Latching> to_latching(std::uint8_t number) {
  return checked_enum(number, Latching::kEndOfSequence);
}

inline constexpr std::uint8_t kMaxOffset = 63;  ///< The AD7147 has a register of six bits for the offset.
inline constexpr double kOffsetStep_pF = 0.32;  ///< Each step subtracts this capacitance (data sheet, nominal).
/// The rest value must lie in the middle third of the range, which begins here.
inline constexpr std::uint16_t kRestLeast = 21846;
inline constexpr std::uint16_t kRestMost = 43690;  ///< The middle third of the range ends here.

struct ModuleOffsets {
  OffsetState state = OffsetState::kNone;
  Latching latching = Latching::kUnknown;
  /// Bit t says that taxel t was outside the middle third at rest when it was last checked.
  std::uint16_t outside = 0;
  std::array<std::uint8_t, layout::kTaxelsPerModule> steps{};  ///< Valid values are 0 to kMaxOffset.
  bool operator==(const ModuleOffsets&) const = default;
};

/// Identifier FD0B carries the offsets of each module, in the order of the table.
struct Offsets {
  static constexpr std::uint16_t kId = did::kOffsets;
  static constexpr std::size_t kRowBytes = 4 + layout::kTaxelsPerModule;
  static constexpr std::size_t kMinBytes = 5, kMaxBytes = kMinBytes + kRowBytes * layout::kMaxModules;
  bool positive_input = false;  ///< The electrodes are on the positive input, so the controller inverts the results.
  std::uint32_t searches = 0;   ///< Completed searches of all modules are counted from power-up.
  std::uint8_t count = 0;       ///< Valid values are 0 to kMaxModules.
  std::array<ModuleOffsets, layout::kMaxModules> modules{};

  /// Returns the modules, indexed by the row of the table.
  [[nodiscard]] constexpr std::span<const ModuleOffsets> rows() const { return std::span(modules).first(count); }
  /// Appends the value in its wire format (docs/protocol.md). `out` is no longer ok() if it lacks room.
  constexpr void encode(ByteWriter& out) const {
    out.u8(positive_input ? 1 : 0);
    out.le32(searches);
    for (const ModuleOffsets& m : rows()) {
      out.u8(wire_number(m.state));
      out.u8(wire_number(m.latching));
      out.le16(m.outside);
      out.bytes(m.steps);
    }
  }
  /// Decodes the wire format. Errors: kBadLength (a partial row, too many), kOutOfRange (no such state, latching or
  /// taxel; a step beyond kMaxOffset).
  [[nodiscard]] static constexpr Result<Offsets> decode(Bytes bytes) {
    if (bytes.size() < kMinBytes || bytes.size() > kMaxBytes || (bytes.size() - kMinBytes) % kRowBytes != 0)
      return std::unexpected(Status::kBadLength);
    ByteReader r(bytes);
    Offsets o;
    const auto positive = checked_bool(r.u8());
    if (!positive) return std::unexpected(positive.error());
    o.positive_input = *positive;
    o.searches = r.le32();
    while (!r.rest().empty()) {
      const auto row = decode_row(r);
      if (!row) return std::unexpected(row.error());
      o.modules[o.count++] = *row;
    }
    return o;
  }
  bool operator==(const Offsets&) const = default;

 private:
  [[nodiscard]] static constexpr Result<ModuleOffsets> decode_row(ByteReader& r) {
    ModuleOffsets m;
    const auto state = to_offset_state(r.u8());
    const auto latching = to_latching(r.u8());
    m.outside = r.le16();
    bool fits = m.outside <= layout::kAllTaxels;
    for (std::uint8_t& s : m.steps) {
      s = r.u8();
      fits = fits && s <= kMaxOffset;
    }
    if (!state || !latching || !fits) return std::unexpected(Status::kOutOfRange);
    m.state = *state;
    m.latching = *latching;
    return m;
  }
};
static_assert(kLengthsAsInTable<Offsets>);

/// Routine 0206 returns whether every module has its offsets.
struct OffsetResult {
  static constexpr std::uint16_t kId = routine::kOffsets;
  static constexpr std::size_t kMinBytes = 1, kMaxBytes = 1;
  bool done = false;

  /// Appends the value in its wire format (docs/protocol.md). `out` is no longer ok() if it lacks room.
  constexpr void encode(ByteWriter& out) const { out.u8(done ? 1 : 0); }
  /// Decodes the wire format. Errors: kBadLength, kOutOfRange.
  [[nodiscard]] static constexpr Result<OffsetResult> decode(Bytes bytes) {
    if (bytes.size() != kMaxBytes) return std::unexpected(Status::kBadLength);
    const auto done = checked_bool(bytes[0]);
    if (!done) return std::unexpected(done.error());
    return OffsetResult{*done};
  }
  bool operator==(const OffsetResult&) const = default;
};
static_assert(kResultAsInTable<OffsetResult>);

}  // namespace triskin::wire
