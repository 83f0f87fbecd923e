// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <algorithm>
#include <array>
#include <cstdint>
#include <optional>

#include "triskin/core/bytes.hpp"
#include "triskin/wire/can_frame.hpp"

/// USB carries the same frames as CAN, one in each packet: HID reports of 64 bytes, or bulk packets of up to 64. See
/// docs/protocol.md, "USB".
namespace triskin::wire {

inline constexpr std::size_t kUsbPacketBytes = 64;
/// A packet can hold a frame of this length. ISO-TP on USB uses FD frames of this length.
inline constexpr std::uint8_t kUsbFrameBytes = 48;

/// Vendor and product are from the pid.codes test range, which no product may ship with.
inline constexpr std::uint16_t kUsbVendor = 0x1209, kUsbProduct = 0x0001, kUsbDfuProduct = 0x0002;
/// The numbers of interfaces and end points are part of the USB descriptors.
inline constexpr std::uint8_t kHidInterface = 0, kBulkInterface = 1, kDfuInterface = 2;
inline constexpr std::uint8_t kHidIn = 0x81, kHidOut = 0x01, kBulkIn = 0x82, kBulkOut = 0x02;

struct UsbPacket {
  std::array<std::uint8_t, kUsbPacketBytes> bytes{};
  std::size_t size = 0;  ///< A bulk packet has this size; HID always sends 64 bytes and fills the rest with 0.
  /// Returns the bytes of the packet in use.
  [[nodiscard]] constexpr Bytes used() const { return Bytes(bytes).first(size); }
};

/// Encodes the number of bytes of the frame + 1, then the identifier (LE; bit 31: 29 bits, bit 30: FD, bit 29: rate
/// switch), then the bytes. Empty: the frame is longer than kUsbFrameBytes.
[[nodiscard]] constexpr std::optional<UsbPacket> to_usb(const CanFrame& f) {
  if (f.size > kUsbFrameBytes) return std::nullopt;
  UsbPacket p;
  ByteWriter w(p.bytes);
  w.u8(static_cast<std::uint8_t>(f.size + 1));
  w.le32(f.id | (f.extended ? 1U << 31 : 0) | (f.fd ? 1U << 30 : 0) | (f.bit_rate_switch ? 1U << 29 : 0));
  w.bytes(f.payload());
  p.size = w.size();
  return p;
}

/// Decodes a packet. Empty: it contains no frame (its first byte is 0), or a malformed one.
[[nodiscard]] constexpr std::optional<CanFrame> from_usb(Bytes packet) {
  ByteReader r(packet);
  const std::uint8_t size = r.u8();
  const std::uint32_t id = r.le32();
  if (!r.ok() || size == 0 || size > kUsbFrameBytes + 1 || packet.size() < 4U + size) return std::nullopt;
  CanFrame f;
  f.size = static_cast<std::uint8_t>(size - 1);
  f.extended = (id >> 31) != 0;
  f.fd = (id >> 30 & 1) != 0;
  f.bit_rate_switch = (id >> 29 & 1) != 0;
  f.id = id & 0x1FFFFFFF;
  if ((!f.extended && f.id > 0x7FF) || (!f.fd && (f.size > 8 || f.bit_rate_switch))) return std::nullopt;
  std::copy_n(packet.begin() + 5, f.size, f.data.begin());
  return f;
}

}  // namespace triskin::wire
