// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <algorithm>
#include <array>
#include <cstdint>

#include "triskin/core/bytes.hpp"
#include "triskin/layout/module.hpp"
#include "triskin/layout/patch_image.hpp"
#include "triskin/wire/checked_enum.hpp"
#include "triskin/wire/identifiers.hpp"
#include "triskin/wire/unique_id.hpp"

/// Identifies a controller and the firmware that runs on it (F186 … F195, FD00, FD01, FD09). See docs/protocol.md.
namespace triskin::wire {

/// A host with another wire version may only identify, read and update the controller.
inline constexpr std::uint16_t kWireVersion = 1;

/// ISO 14229-1, 10.2, defines the diagnostic sessions.
enum class Session : std::uint8_t { kDefault = 1, kProgramming = 2, kExtended = 3 };
/// Converts a number from the wire. Error: kOutOfRange.
[[nodiscard]] constexpr Result<Session> to_session(std::uint8_t number) {
  if (number < wire_number(Session::kDefault)) return std::unexpected(Status::kOutOfRange);
  return checked_enum(number, Session::kExtended);
}

/// Identifier F186 carries this value.
struct ActiveSession {
  static constexpr std::uint16_t kId = did::kActiveSession;
  static constexpr std::size_t kMinBytes = 1, kMaxBytes = 1;
  Session session = Session::kDefault;

  /// Appends the value in its wire format (docs/protocol.md). `out` is no longer ok() if it lacks room.
  constexpr void encode(ByteWriter& out) const { out.u8(wire_number(session)); }
  /// Decodes the wire format. Errors: kBadLength, kOutOfRange.
  [[nodiscard]] static constexpr Result<ActiveSession> decode(Bytes bytes) {
    if (bytes.size() != kMaxBytes) return std::unexpected(Status::kBadLength);
    const auto session = to_session(bytes[0]);
    if (!session) return std::unexpected(session.error());
    return ActiveSession{*session};
  }
  bool operator==(const ActiveSession&) const = default;
};
static_assert(kLengthsAsInTable<ActiveSession>);

/// Identifier F18C carries this value.
struct SerialNumber {
  static constexpr std::uint16_t kId = did::kSerialNumber;
  static constexpr std::size_t kMinBytes = UniqueId{}.size(), kMaxBytes = kMinBytes;
  UniqueId unique_id{};

  /// Appends the value in its wire format (docs/protocol.md). `out` is no longer ok() if it lacks room.
  constexpr void encode(ByteWriter& out) const { out.bytes(unique_id); }
  /// Decodes the wire format. Error: kBadLength.
  [[nodiscard]] static constexpr Result<SerialNumber> decode(Bytes bytes) {
    SerialNumber s;
    if (bytes.size() != s.unique_id.size()) return std::unexpected(Status::kBadLength);
    std::ranges::copy(bytes, s.unique_id.begin());
    return s;
  }
  bool operator==(const SerialNumber&) const = default;
};
static_assert(kLengthsAsInTable<SerialNumber>);

/// The kind of board is a letter or digit; an image for another kind is refused (docs/port.md).
#ifndef TRISKIN_BOARD_KIND
#define TRISKIN_BOARD_KIND '1'
#endif

/// F190 and F191 return this text on every board of this kind.
inline constexpr std::array<std::uint8_t, 8> kPartNumber{'T', 'R', 'I', 'S', 'K', 'I', 'N', TRISKIN_BOARD_KIND};
static_assert(identifier(did::kPartNumber).max_bytes == kPartNumber.size());
static_assert(identifier(did::kHardware).max_bytes == kPartNumber.size());

/// F195 is big-endian, so that the bytes are major, minor, patch, build.
struct FirmwareVersion {
  static constexpr std::uint16_t kId = did::kFirmware;
  static constexpr std::size_t kMinBytes = 4, kMaxBytes = 4;
  std::uint32_t version = 0;  ///< The major number is in the highest byte, so that versions compare as integers.

  /// Appends the value in its wire format (docs/protocol.md). `out` is no longer ok() if it lacks room.
  constexpr void encode(ByteWriter& out) const { out.be32(version); }
  /// Decodes the wire format. Error: kBadLength.
  [[nodiscard]] static constexpr Result<FirmwareVersion> decode(Bytes bytes) {
    if (bytes.size() != kMaxBytes) return std::unexpected(Status::kBadLength);
    return FirmwareVersion{ByteReader(bytes).be32()};
  }
  bool operator==(const FirmwareVersion&) const = default;
};
static_assert(kLengthsAsInTable<FirmwareVersion>);

/// Identifier FD00 carries this value, which a host needs before it sends any other request.
struct Hello {
  static constexpr std::uint16_t kId = did::kHello;
  static constexpr std::size_t kMinBytes = 23, kMaxBytes = 23;
  /// The layout up to the unique id is the same in every wire version.
  static constexpr std::size_t kFixedBytes = 21;
  std::uint16_t wire_version = kWireVersion, layout_version = layout::kLayoutVersion;
  std::uint32_t firmware_version = 0;
  std::uint8_t node_address = layout::kFirstNode;
  UniqueId unique_id{};
  std::uint8_t max_modules = layout::kMaxModules;
  std::uint8_t taxels_per_module = layout::kTaxelsPerModule;

  /// Appends the value in its wire format (docs/protocol.md). `out` is no longer ok() if it lacks room.
  constexpr void encode(ByteWriter& out) const {
    out.le16(wire_version);
    out.le16(layout_version);
    out.le32(firmware_version);
    out.u8(node_address);
    out.bytes(unique_id);
    out.u8(max_modules);
    out.u8(taxels_per_module);
  }
  /// Accepts any wire version. Of another version it reads only the first kFixedBytes and sets the limits to 0. Errors:
  /// kTooShort, kBadLength, kOutOfRange (node address; limits beyond those of layout/module.hpp).
  [[nodiscard]] static constexpr Result<Hello> decode(Bytes bytes) {
    if (bytes.size() < kFixedBytes) return std::unexpected(Status::kTooShort);
    ByteReader r(bytes);
    Hello h;
    h.wire_version = r.le16();
    h.layout_version = r.le16();
    h.firmware_version = r.le32();
    h.node_address = r.u8();
    for (std::uint8_t& b : h.unique_id) b = r.u8();
    h.max_modules = h.taxels_per_module = 0;
    if (!layout::is_node_address(h.node_address)) return std::unexpected(Status::kOutOfRange);
    if (h.wire_version != kWireVersion) return h;
    if (bytes.size() != kMaxBytes) return std::unexpected(Status::kBadLength);
    h.max_modules = r.u8();
    h.taxels_per_module = r.u8();
    if (h.max_modules < 1 || h.max_modules > layout::kMaxModules || h.taxels_per_module != layout::kTaxelsPerModule)
      return std::unexpected(Status::kOutOfRange);
    return h;
  }
  bool operator==(const Hello&) const = default;
};
static_assert(kLengthsAsInTable<Hello>);

/// Identifier FD01 carries this value.
struct NodeAddress {
  static constexpr std::uint16_t kId = did::kNodeAddress;
  static constexpr std::size_t kMinBytes = 1, kMaxBytes = 1;
  std::uint8_t address = layout::kFirstNode;

  /// Appends the value in its wire format (docs/protocol.md). `out` is no longer ok() if it lacks room.
  constexpr void encode(ByteWriter& out) const { out.u8(address); }
  /// Decodes the wire format. Errors: kBadLength, kOutOfRange.
  [[nodiscard]] static constexpr Result<NodeAddress> decode(Bytes bytes) {
    if (bytes.size() != kMaxBytes) return std::unexpected(Status::kBadLength);
    if (!layout::is_node_address(bytes[0])) return std::unexpected(Status::kOutOfRange);
    return NodeAddress{bytes[0]};
  }
  bool operator==(const NodeAddress&) const = default;
};
static_assert(kLengthsAsInTable<NodeAddress>);

/// Identifier FD09 describes the firmware image that runs.
struct ImageState {
  static constexpr std::uint16_t kId = did::kImageState;
  static constexpr std::size_t kMinBytes = 14, kMaxBytes = 14;
  std::uint8_t slot = 0;   ///< Valid values are 0 and 1.
  bool confirmed = false;  ///< The image has confirmed that it works.
  /// The sequence is higher than that of the other slot by one, so the newer image has the larger number.
  std::uint32_t sequence = 0;
  std::uint32_t size_bytes = 0;
  std::uint32_t record_crc = 0;  ///< The commit record stores layout::slot_crc() of the image here.

  /// Appends the value in its wire format (docs/protocol.md). `out` is no longer ok() if it lacks room.
  constexpr void encode(ByteWriter& out) const {
    out.u8(slot);
    out.u8(confirmed ? 1 : 0);
    out.le32(sequence);
    out.le32(size_bytes);
    out.le32(record_crc);
  }
  /// Decodes the wire format. Errors: kBadLength, kOutOfRange (a third slot; a flag other than 0 or 1).
  [[nodiscard]] static constexpr Result<ImageState> decode(Bytes bytes) {
    if (bytes.size() != kMaxBytes) return std::unexpected(Status::kBadLength);
    ByteReader r(bytes);
    ImageState s;
    s.slot = r.u8();
    const auto confirmed = checked_bool(r.u8());
    if (s.slot > 1 || !confirmed) return std::unexpected(Status::kOutOfRange);
    s.confirmed = *confirmed;
    s.sequence = r.le32();
    s.size_bytes = r.le32();
    s.record_crc = r.le32();
    return s;
  }
  bool operator==(const ImageState&) const = default;
};
static_assert(kLengthsAsInTable<ImageState>);

/// Routine 0207 returns kOk, or kFlashFailed when the board cannot protect its flash or is not ready yet.
struct ProtectionResult {
  static constexpr std::uint16_t kId = routine::kProtectLoader;
  static constexpr std::size_t kMinBytes = 1, kMaxBytes = 1;
  Status status = Status::kEmpty;

  /// Appends the value in its wire format (docs/protocol.md). `out` is no longer ok() if it lacks room.
  constexpr void encode(ByteWriter& out) const { out.u8(wire_number(status)); }
  /// Decodes the wire format. Errors: kBadLength, kOutOfRange.
  [[nodiscard]] static constexpr Result<ProtectionResult> decode(Bytes bytes) {
    if (bytes.size() != kMaxBytes) return std::unexpected(Status::kBadLength);
    const auto status = to_status(bytes[0]);
    if (!status) return std::unexpected(status.error());
    return ProtectionResult{*status};
  }
  bool operator==(const ProtectionResult&) const = default;
};
static_assert(kResultAsInTable<ProtectionResult>);

}  // namespace triskin::wire
