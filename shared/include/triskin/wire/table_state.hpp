// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>

#include "triskin/core/bytes.hpp"
#include "triskin/layout/module.hpp"
#include "triskin/wire/checked_enum.hpp"
#include "triskin/wire/identifiers.hpp"

/// Identifier FD02 and routine 0205 concern the table that a controller works with; see docs/protocol.md.
namespace triskin::wire {

/// Identifier FD02 carries this value. Without a table every field except the status is 0.
struct ActiveTable {
  static constexpr std::uint16_t kId = did::kActiveTable;
  static constexpr std::size_t kMinBytes = 18, kMaxBytes = 18;
  Status status = Status::kEmpty;  ///< kOk means that there is a table.
  std::uint32_t sequence = 0;      ///< Activations are counted, so the newest table has the highest number.
  std::uint64_t design_id = 0;
  std::uint32_t crc = 0;     ///< The CRC-32 covers the image as it was flashed.
  std::uint8_t modules = 0;  ///< Valid values are 1 to kMaxModules.

  /// Returns true when there is a table.
  [[nodiscard]] constexpr bool present() const { return status == Status::kOk; }
  /// Appends the value in its wire format (docs/protocol.md). `out` is no longer ok() if it lacks room.
  constexpr void encode(ByteWriter& out) const {
    out.u8(wire_number(status));
    out.le32(sequence);
    out.le64(design_id);
    out.le32(crc);
    out.u8(modules);
  }
  /// Decodes the wire format. Errors: kBadLength, kOutOfRange (no such status; modules without a table, or a table
  /// without modules).
  [[nodiscard]] static constexpr Result<ActiveTable> decode(Bytes bytes) {
    if (bytes.size() != kMaxBytes) return std::unexpected(Status::kBadLength);
    ByteReader r(bytes);
    const auto status = to_status(r.u8());
    if (!status) return std::unexpected(status.error());
    ActiveTable t;
    t.status = *status;
    t.sequence = r.le32();
    t.design_id = r.le64();
    t.crc = r.le32();
    t.modules = r.u8();
    if (t.modules > layout::kMaxModules || t.present() != (t.modules > 0)) return std::unexpected(Status::kOutOfRange);
    return t;
  }
  bool operator==(const ActiveTable&) const = default;
};
static_assert(kLengthsAsInTable<ActiveTable>);

/// Routine 0205 returns kOk, or the reason why the table was not replaced.
struct ActivationResult {
  static constexpr std::uint16_t kId = routine::kActivate;
  static constexpr std::size_t kMinBytes = 1, kMaxBytes = 1;
  Status status = Status::kEmpty;

  /// Appends the value in its wire format (docs/protocol.md). `out` is no longer ok() if it lacks room.
  constexpr void encode(ByteWriter& out) const { out.u8(wire_number(status)); }
  /// Decodes the wire format. Errors: kBadLength, kOutOfRange.
  [[nodiscard]] static constexpr Result<ActivationResult> decode(Bytes bytes) {
    if (bytes.size() != kMaxBytes) return std::unexpected(Status::kBadLength);
    const auto status = to_status(bytes[0]);
    if (!status) return std::unexpected(status.error());
    return ActivationResult{*status};
  }
  bool operator==(const ActivationResult&) const = default;
};
static_assert(kResultAsInTable<ActivationResult>);

}  // namespace triskin::wire
