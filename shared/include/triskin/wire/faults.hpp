// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <cstdint>
#include <span>

#include "triskin/core/bytes.hpp"
#include "triskin/layout/module.hpp"
#include "triskin/wire/checked_enum.hpp"
#include "triskin/wire/identifiers.hpp"
#include "triskin/wire/module_state.hpp"

/// Services 14 and 19 access the fault memory; see docs/protocol.md.
namespace triskin::wire {

/// A controller uses these bits of a fault's status byte (ISO 14229-1, D.2).
namespace fault_status {
inline constexpr std::uint8_t kFailsNow = 0x01, kConfirmed = 0x08, kAvailable = kFailsNow | kConfirmed;
}

/// The diagnostic trouble code of a module has 3 bytes: 9 and the state, then 0, then the row of the table.
struct FaultCode {
  static constexpr std::uint32_t kGroup = 0x900000, kGroupMask = 0xF00000, kMaxCode = 0xFFFFFF;
  ModuleState state = kFirstFaultState;  ///< Only states that are faults are recorded.
  std::uint8_t row = 0;                  ///< Valid values are 0 to kMaxModules − 1.

  /// Returns the trouble code as a number of 24 bits.
  [[nodiscard]] constexpr std::uint32_t dtc() const { return kGroup | static_cast<std::uint32_t>(state) << 16 | row; }
  /// Splits a trouble code. Error: kOutOfRange (another group, a state that is not a fault, no such row).
  [[nodiscard]] static constexpr Result<FaultCode> of(std::uint32_t dtc) {
    const auto state = to_module_state(static_cast<std::uint8_t>(dtc >> 16 & 0xF));
    if (dtc > kMaxCode || (dtc & (kGroupMask | 0xFF00U)) != kGroup || !state || *state < kFirstFaultState ||
        (dtc & 0xFF) >= layout::kMaxModules)
      return std::unexpected(Status::kOutOfRange);
    return FaultCode{*state, static_cast<std::uint8_t>(dtc & 0xFF)};
  }
  bool operator==(const FaultCode&) const = default;
};

struct FaultRecord {
  FaultCode code;
  std::uint8_t status = 0;  ///< The bits are defined in fault_status.
  /// Returns true while the fault is present.
  [[nodiscard]] constexpr bool fails_now() const { return (status & fault_status::kFailsNow) != 0; }
  bool operator==(const FaultRecord&) const = default;
};

/// Appends a trouble code as three bytes, big-endian.
constexpr void encode_dtc(std::uint32_t dtc, ByteWriter& out) {
  out.u8(static_cast<std::uint8_t>(dtc >> 16));
  out.be16(static_cast<std::uint16_t>(dtc));
}

/// The answer to 19 02 has, after the sub-function, the status bits that the controller supports, then the faults.
struct FaultList {
  static constexpr std::size_t kRecordBytes = 4, kFaultsPerModule = kModuleStateCount - 2;
  static constexpr std::size_t kMaxRecords = kFaultsPerModule * layout::kMaxModules;
  std::uint8_t available = fault_status::kAvailable;
  std::uint8_t count = 0;  ///< Valid values are 0 to kMaxRecords.
  std::array<FaultRecord, kMaxRecords> records{};

  /// Returns the records in use.
  [[nodiscard]] constexpr std::span<const FaultRecord> faults() const { return std::span(records).first(count); }
  /// Appends a record; the caller makes sure that there is room (kMaxRecords).
  constexpr void add(const FaultRecord& r) { records[count++] = r; }
  /// Appends the value in its wire format (docs/protocol.md). `out` is no longer ok() if it lacks room.
  constexpr void encode(ByteWriter& out) const {
    out.u8(available);
    for (const FaultRecord& f : faults()) encode(f, out);
  }
  /// Appends one record, for a sender that cannot hold a whole list in memory.
  static constexpr void encode(const FaultRecord& f, ByteWriter& out) {
    encode_dtc(f.code.dtc(), out);
    out.u8(f.status);
  }
  /// Decodes the wire format. Errors: kTooShort, kBadLength (half a record, too many), kOutOfRange (a code that is no
  /// fault of a module, a status with unsupported bits).
  [[nodiscard]] static constexpr Result<FaultList> decode(Bytes bytes) {
    if (bytes.empty()) return std::unexpected(Status::kTooShort);
    if ((bytes.size() - 1) % kRecordBytes != 0 || bytes.size() > 1 + kRecordBytes * kMaxRecords)
      return std::unexpected(Status::kBadLength);
    ByteReader r(bytes);
    FaultList list;
    list.available = r.u8();
    while (!r.rest().empty()) {
      const std::uint32_t word = r.be32();
      const auto code = FaultCode::of(word >> 8);
      const auto status = static_cast<std::uint8_t>(word);
      if (!code || (status & ~list.available) != 0) return std::unexpected(Status::kOutOfRange);
      list.add({*code, status});
    }
    return list;
  }
  bool operator==(const FaultList&) const = default;
};

/// The fault first occurred at this time and sample number.
struct Freeze {
  std::uint32_t time_ms = 0;  ///< The time is counted from power-up, because the board has no calendar.
  std::uint32_t sample = 0;   ///< Samples of the module are counted from power-up.
  bool operator==(const Freeze&) const = default;
};

/// The answer to 19 04 has, after the sub-function, one record that holds FD21 and FD22.
struct FreezeFrame {
  static constexpr std::size_t kBytes = 18;
  static constexpr std::uint8_t kRecord = 1, kValues = 2;
  FaultRecord fault;
  Freeze freeze;

  /// Appends the value in its wire format (docs/protocol.md). `out` is no longer ok() if it lacks room.
  constexpr void encode(ByteWriter& out) const {
    FaultList::encode(fault, out);
    out.u8(kRecord);
    out.u8(kValues);
    out.be16(did::kFreezeTime);
    out.le32(freeze.time_ms);
    out.be16(did::kFreezeSample);
    out.le32(freeze.sample);
  }
  /// Decodes the wire format. Errors: kBadLength, kOutOfRange (another code, record or identifier).
  [[nodiscard]] static constexpr Result<FreezeFrame> decode(Bytes bytes) {
    if (bytes.size() != kBytes) return std::unexpected(Status::kBadLength);
    ByteReader r(bytes);
    const std::uint32_t word = r.be32();
    const auto code = FaultCode::of(word >> 8);
    if (!code || r.u8() != kRecord || r.u8() != kValues) return std::unexpected(Status::kOutOfRange);
    FreezeFrame f{{*code, static_cast<std::uint8_t>(word)}, {}};
    if (r.be16() != did::kFreezeTime) return std::unexpected(Status::kOutOfRange);
    f.freeze.time_ms = r.le32();
    if (r.be16() != did::kFreezeSample) return std::unexpected(Status::kOutOfRange);
    f.freeze.sample = r.le32();
    return f;
  }
  bool operator==(const FreezeFrame&) const = default;
};

}  // namespace triskin::wire
