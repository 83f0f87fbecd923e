// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstdint>
#include <span>
#include <vector>

namespace triskin::machine {

/// Reply of the device to a token of the host. kNone: no reply.
enum class UsbReply { kNone, kNak, kStall, kAck };

struct UsbIn {
  UsbReply reply = UsbReply::kNone;  ///< kAck: data came and the host acknowledges them
  bool data1 = false;
  std::vector<std::uint8_t> bytes;
};

/// The device's end of the USB cable. A transaction happens at the present time and takes none: the host's side spends
/// it.
class UsbWire {
 public:
  virtual ~UsbWire() = default;
  /// True while the device holds its pull-up on D+: the host sees it plugged in.
  [[nodiscard]] virtual bool attached() const = 0;
  /// The host drives a bus reset: the device answers at address 0 afterwards.
  virtual void bus_reset() = 0;
  /// Nothing on the bus for 3 ms, and activity after that.
  virtual void bus_suspend(bool suspended) = 0;
  /// SETUP transaction to endpoint 0 of the device at `address` (0..127). kNone: no device there, or endpoint 0 is off.
  virtual UsbReply setup(std::uint8_t address, std::span<const std::uint8_t, 8> bytes) = 0;
  /// OUT transaction; `data1` is the data toggle. kNak: the endpoint has no room, kStall: it is halted, kNone: nobody
  /// answers.
  virtual UsbReply out(std::uint8_t address, std::uint8_t endpoint, bool data1,
                       std::span<const std::uint8_t> bytes) = 0;
  /// IN transaction: asks an endpoint for one packet. kNak: it has none, kStall: it is halted, kNone: nobody answers.
  virtual UsbIn in(std::uint8_t address, std::uint8_t endpoint) = 0;
};

}  // namespace triskin::machine
