// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <cstdint>
#include <optional>

#include "triskin/core/bytes.hpp"

namespace triskin::wire {

/// The eight bytes of a control transfer's first stage (USB 2.0 §9.3).
struct UsbSetup {
  std::uint8_t type = 0, request = 0;
  std::uint16_t value = 0, index = 0, length = 0;
  /// True when the data stage goes from the device to the host.
  [[nodiscard]] constexpr bool to_host() const { return (type & 0x80) != 0; }
};

/// The setup stage at the head of `bytes`, which holds at least eight.
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

/// A USB device seen from the bus: what a device controller, or a simulated one, hands over. Full speed, no heap, does
/// not block. SET_ADDRESS is the business of the caller.
class UsbFunction {
 public:
  virtual ~UsbFunction() = default;
  /// Reset of the bus, or unplugged: unconfigured, queues empty.
  virtual void reset() = 0;
  /// A whole control transfer: `out` is the data stage to the device, the result the one to the host (at most
  /// setup.length is sent; valid until the next call). Empty optional: stall.
  virtual std::optional<Bytes> control(const UsbSetup& setup, Bytes out) = 0;
  /// A packet for an end point of the host's direction "out".
  virtual void out(std::uint8_t endpoint, Bytes packet) = 0;
  /// The next packet of an end point of direction "in"; empty: none. Valid until the next call.
  virtual Bytes in(std::uint8_t endpoint) = 0;
  /// True when the board should detach and attach it again.
  /// Wants to leave the bus and come back as another device (DFU).
  [[nodiscard]] virtual bool wants_to_reconnect() const = 0;
};

}  // namespace triskin::wire
