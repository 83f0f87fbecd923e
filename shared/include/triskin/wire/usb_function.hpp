// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <cstdint>
#include <optional>

#include "triskin/core/bytes.hpp"

namespace triskin::wire {

/// The setup stage of a control transfer has these eight bytes (USB 2.0 §9.3).
struct UsbSetup {
  std::uint8_t type = 0, request = 0;
  std::uint16_t value = 0, index = 0, length = 0;
  /// Returns true when the data stage goes from the device to the host.
  [[nodiscard]] constexpr bool to_host() const { return (type & 0x80) != 0; }
};

/// Decodes the setup stage from the first eight bytes of `bytes`.
inline UsbSetup setup_of(Bytes bytes) {
  ByteReader r(bytes);
  UsbSetup s;
  s.type = r.u8();
  s.request = r.u8();
  s.value = r.le16();
  s.index = r.le16();
  s.length = r.le16();
  return s;
}

/// The interface is a USB device as the bus sees it; a real or simulated device controller calls it. It is full speed,
/// uses no heap and never blocks. The caller handles SET_ADDRESS itself.
class UsbFunction {
 public:
  virtual ~UsbFunction() = default;
  /// Handles a bus reset or unplugging: the device is unconfigured and its queues are empty afterwards.
  virtual void reset() = 0;
  /// Handles a whole control transfer: `out` is the data stage to the device, the result is the one to the host (at
  /// most setup.length bytes are sent; valid until the next call). An empty optional means stall.
  virtual std::optional<Bytes> control(const UsbSetup& setup, Bytes out) = 0;
  /// Handles a packet for an end point of the host's direction "out".
  virtual void out(std::uint8_t endpoint, Bytes packet) = 0;
  /// Returns the next packet of an end point of direction "in", or an empty span. It is valid until the next call.
  virtual Bytes in(std::uint8_t endpoint) = 0;
  /// Returns true when the device wants to leave the bus and come back as another device (DFU), so the board should
  /// detach and attach it again.
  [[nodiscard]] virtual bool wants_to_reconnect() const = 0;
};

}  // namespace triskin::wire
