// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <cstdint>
#include <span>

#include "triskin/core/bytes.hpp"
#include "triskin/layout/module.hpp"
#include "triskin/wire/identifiers.hpp"

namespace triskin::wire {

/// Identifier FD0F says what each taxel read when its offset was settled (FD0B), in counts; pressure lowers it. Of a
/// skin that nobody touched meanwhile it is the rest. An electrode that no offset cancels whole rests anywhere in the
/// range.
struct SettledRest {
  static constexpr std::uint16_t kId = did::kSettledRest;
  static constexpr std::size_t kRowBytes = 2 * layout::kTaxelsPerModule, kMinBytes = 1,
                               kMaxBytes = kMinBytes + kRowBytes * layout::kMaxModules;
  using Module = std::array<std::uint16_t, layout::kTaxelsPerModule>;
  std::uint8_t count = 0;  ///< Valid values are 0 to kMaxModules.
  std::array<Module, layout::kMaxModules> modules{};

  /// Returns true if the offsets of this module were settled; until then its values are 0.
  [[nodiscard]] static constexpr bool known(const Module& module) { return module != Module{}; }
  /// Returns the modules, indexed by the row of the table.
  [[nodiscard]] constexpr std::span<const Module> rows() const { return std::span(modules).first(count); }
  /// Appends the value in its wire format (docs/protocol.md). `out` is no longer ok() if it lacks room.
  constexpr void encode(ByteWriter& out) const {
    out.u8(count);
    for (const Module& m : rows()) {
      for (const std::uint16_t counts : m) out.le16(counts);
    }
  }
  /// Decodes the wire format. Error: kBadLength (other modules than it says, or too many).
  [[nodiscard]] static constexpr Result<SettledRest> decode(Bytes bytes) {
    ByteReader r(bytes);
    SettledRest rest;
    if (bytes.size() >= kMinBytes) rest.count = r.u8();
    if (rest.count > layout::kMaxModules || bytes.size() != kMinBytes + kRowBytes * rest.count)
      return std::unexpected(Status::kBadLength);
    for (Module& m : std::span(rest.modules).first(rest.count)) {
      for (std::uint16_t& counts : m) counts = r.le16();
    }
    return rest;
  }
  bool operator==(const SettledRest&) const = default;
};
static_assert(kLengthsAsInTable<SettledRest>);

}  // namespace triskin::wire
