// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <cstdint>
#include <span>

#include "triskin/core/bytes.hpp"
#include "triskin/layout/module.hpp"
#include "triskin/wire/checked_enum.hpp"
#include "triskin/wire/identifiers.hpp"

namespace triskin::wire {

struct ModuleTaxels {
  std::uint16_t valid = 0;  ///< Bit t belongs to taxel t.
  /// The converter's results are not compensated.
  std::array<std::uint16_t, layout::kTaxelsPerModule> value{};
  /// Returns true when the value of `taxel` (0..11) is valid.
  [[nodiscard]] constexpr bool is_valid(std::size_t taxel) const { return (valid >> taxel & 1U) != 0; }
  bool operator==(const ModuleTaxels&) const = default;
};

/// Identifier FD10 carries the latest readings of all modules in the table, even if nothing is streamed.
struct LiveTaxels {
  static constexpr std::uint16_t kId = did::kLiveTaxels;
  static constexpr std::size_t kMinBytes = 12, kModuleBytes = 2 + 2 * layout::kTaxelsPerModule,
                               kMaxBytes = kMinBytes + kModuleBytes * layout::kMaxModules;
  std::uint32_t sequences = 0;  ///< Nominal sequences are counted from power-up.
  std::uint64_t time_us = 0;    ///< The controller's clock was read for this answer.
  std::uint8_t count = 0;       ///< The table has 0 … kMaxModules modules.
  std::array<ModuleTaxels, layout::kMaxModules> modules{};

  /// Returns the readings of the modules, indexed by the row of the table.
  [[nodiscard]] constexpr std::span<const ModuleTaxels> rows() const { return std::span(modules).first(count); }
  /// Appends the value in its wire format (docs/protocol.md). `out` is no longer ok() if it lacks room.
  constexpr void encode(ByteWriter& out) const {
    out.le32(sequences);
    out.le64(time_us);
    for (const ModuleTaxels& m : rows()) {
      out.le16(m.valid);
      for (const std::uint16_t v : m.value) out.le16(v);
    }
  }
  /// Decodes the wire format. Errors: kBadLength (a partial module, or too many), kOutOfRange (a taxel that a module
  /// does not have).
  [[nodiscard]] static constexpr Result<LiveTaxels> decode(Bytes bytes) {
    if (bytes.size() < kMinBytes || bytes.size() > kMaxBytes || (bytes.size() - kMinBytes) % kModuleBytes != 0)
      return std::unexpected(Status::kBadLength);
    ByteReader r(bytes);
    LiveTaxels t;
    t.sequences = r.le32();
    t.time_us = r.le64();
    t.count = static_cast<std::uint8_t>((bytes.size() - kMinBytes) / kModuleBytes);
    for (ModuleTaxels& m : std::span(t.modules).first(t.count)) {
      m.valid = r.le16();
      if (m.valid > layout::kAllTaxels) return std::unexpected(Status::kOutOfRange);
      for (std::uint16_t& v : m.value) v = r.le16();
    }
    return t;
  }
  bool operator==(const LiveTaxels&) const = default;
};
static_assert(kLengthsAsInTable<LiveTaxels>);

}  // namespace triskin::wire
