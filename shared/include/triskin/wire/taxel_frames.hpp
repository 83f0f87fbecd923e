// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <cstdint>

#include "triskin/core/status.hpp"
#include "triskin/layout/patch_image.hpp"
#include "triskin/wire/can_frame.hpp"
#include "triskin/wire/module_state.hpp"

/// docs/protocol.md, "Data stream", describes taxels on the wire.
namespace triskin::wire {

/// An iCub MTB4 board sends the taxels of one module in 8 bits each: two CAN frames with id 0x400 | board << 4 |
/// module.
struct IcubTaxels {
  std::uint8_t board = 0;   ///< Valid values are 0 to 15.
  std::uint8_t module = 0;  ///< The triangle has number 4 · line + address, from 0 to 15.
  std::array<std::uint8_t, layout::kTaxelsPerModule>
      value{};  ///< A taxel reads 245 at rest, unless the host asks for another value, and less under pressure.
  std::uint16_t out_of_range = 0;  ///< Bit t belongs to taxel t.
  bool no_acknowledge = false;
  bool not_connected = false;
  bool operator==(const IcubTaxels&) const = default;
};
inline constexpr std::uint8_t kIcubFirst = 0x40, kIcubSecond = 0xC0;

/// Returns the two frames of a module in the iCub stream, in order.
[[nodiscard]] constexpr std::array<CanFrame, 2> encode_icub(const IcubTaxels& t) {
  std::array<CanFrame, 2> frames{};
  for (CanFrame& f : frames) {
    f.id = 0x400U | static_cast<std::uint32_t>(t.board & 0xF) << 4 | (t.module & 0xFU);
    f.size = 8;
  }
  frames[0].data[0] = kIcubFirst;
  for (std::size_t k = 0; k < 7; ++k) frames[0].data[1 + k] = t.value[k];
  frames[1].data[0] = kIcubSecond;
  for (std::size_t k = 0; k < 5; ++k) frames[1].data[1 + k] = t.value[7 + k];
  frames[1].data[6] = static_cast<std::uint8_t>(t.out_of_range >> 4);
  frames[1].data[7] =
      static_cast<std::uint8_t>((t.out_of_range & 0xF) << 4 | (t.not_connected ? 2 : 0) | (t.no_acknowledge ? 1 : 0));
  return frames;
}

/// Joins the two frames of one module. Errors: kBadLength, kOutOfRange (not a skin identifier, or not a first and a
/// second frame).
[[nodiscard]] constexpr Result<IcubTaxels> decode_icub(const CanFrame& first, const CanFrame& second) {
  if (first.size != 8 || second.size != 8) return std::unexpected(Status::kBadLength);
  if (first.extended || second.extended || (first.id & 0x700U) != 0x400 || first.id != second.id)
    return std::unexpected(Status::kOutOfRange);
  if (first.data[0] != kIcubFirst || second.data[0] != kIcubSecond) return std::unexpected(Status::kOutOfRange);
  IcubTaxels t;
  t.board = static_cast<std::uint8_t>(first.id >> 4 & 0xF);
  t.module = static_cast<std::uint8_t>(first.id & 0xF);
  for (std::size_t k = 0; k < 7; ++k) t.value[k] = first.data[1 + k];
  for (std::size_t k = 0; k < 5; ++k) t.value[7 + k] = second.data[1 + k];
  t.out_of_range = static_cast<std::uint16_t>(second.data[6] << 4 | second.data[7] >> 4);
  t.no_acknowledge = (second.data[7] & 1) != 0;
  t.not_connected = (second.data[7] & 2) != 0;
  return t;
}

/// A frame carries one sample of one module in full. It is a 48-byte CAN FD frame with id 0x18F0‹node›‹module›,
/// too long for a classic frame.
struct TaxelFrame {
  std::uint8_t node_address = 0;
  /// The number is a row of the table, or an adopted module if it is not less than the number of rows (Adoption).
  std::uint8_t module = 0;
  std::uint32_t sample = 0;  ///< All samples of the module that were due are counted, so a gap means a lost sample.
  std::uint64_t device_time_us = 0;
  std::uint16_t valid = 0;  ///< Bit t belongs to taxel t.
  ModuleState state = ModuleState::kUnknown;
  std::array<std::uint16_t, layout::kTaxelsPerModule> value{};
  // These fields form the trailer; a controller that does not know it leaves them 0.
  std::uint32_t dropped = 0;  ///< This many samples of the module found no room before this one (RowAccount::dropped).
  std::uint16_t unread = 0;   ///< This many samples were not read in time, modulo 65536 (RowAccount::unread).
  std::uint8_t starts = 0;    ///< Sampling has restarted this often, modulo 256 (StreamAccount::starts).
  /// For an adopted module this is the list that `module` refers to (Adoption::list); for a row of the table it is 0.
  std::uint8_t adopted_modules = 0;
  bool operator==(const TaxelFrame&) const = default;
};
inline constexpr std::uint32_t kFullBase = 0x18F00000;
inline constexpr std::uint8_t kFullBytes = 48;

/// Encodes a module's sample as a frame of the full stream (CAN FD).
[[nodiscard]] constexpr CanFrame encode_full(const TaxelFrame& t) {
  CanFrame f;
  f.id = kFullBase | static_cast<std::uint32_t>(t.node_address) << 8 | t.module;
  f.extended = f.fd = f.bit_rate_switch = true;
  f.size = kFullBytes;
  ByteWriter w(std::span(f.data).first(kFullBytes));
  w.le32(t.sample);
  w.le64(t.device_time_us);
  w.le16(t.valid);
  w.u8(wire_number(t.state));
  w.u8(t.module);
  for (const std::uint16_t v : t.value) w.le16(v);
  w.le32(t.dropped);
  w.le16(t.unread);
  w.u8(t.starts);
  w.u8(t.adopted_modules);
  return f;
}

/// Decodes a frame of the full stream. Errors: kBadLength, kOutOfRange (another identifier; a taxel, state or row that
/// does not exist).
[[nodiscard]] constexpr Result<TaxelFrame> decode_full(const CanFrame& f) {
  if (!f.extended || !f.fd || (f.id & 0x1FFF0000U) != kFullBase) return std::unexpected(Status::kOutOfRange);
  if (f.size != kFullBytes) return std::unexpected(Status::kBadLength);
  TaxelFrame t;
  t.node_address = static_cast<std::uint8_t>(f.id >> 8);
  ByteReader r(f.payload());
  t.sample = r.le32();
  t.device_time_us = r.le64();
  t.valid = r.le16();
  const auto state = to_module_state(r.u8());
  t.module = r.u8();
  if (!state || t.valid > layout::kAllTaxels) return std::unexpected(Status::kOutOfRange);
  t.state = *state;
  if (t.module >= layout::kMaxModules || t.module != (f.id & 0xFF)) return std::unexpected(Status::kOutOfRange);
  for (std::uint16_t& v : t.value) v = r.le16();
  t.dropped = r.le32();
  t.unread = r.le16();
  t.starts = r.u8();
  t.adopted_modules = r.u8();
  return t;
}

}  // namespace triskin::wire
