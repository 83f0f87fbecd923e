// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstdint>
#include <span>
#include <vector>

namespace triskin::machine {

/// kNone means that the device sends no reply to a token of the host.
enum class UsbReply { kNone, kNak, kStall, kAck };

struct UsbIn {
  UsbReply reply = UsbReply::kNone;  ///< kAck means that data arrived and the host acknowledges them.
  bool data1 = false;
  std::vector<std::uint8_t> bytes;
};

/// Represents the device's end of the USB cable. A transaction happens at the present time and takes none; the host's
/// side adds the time.
class UsbWire {
 public:
  virtual ~UsbWire() = default;
  /// Returns true while the device holds its pull-up on D+, by which the host sees it plugged in.
  [[nodiscard]] virtual bool attached() const = 0;
  /// Makes the host drive a bus reset; afterwards the device answers at address 0.
  virtual void bus_reset() = 0;
  /// Reports that the bus was idle for 3 ms, or active again after that.
  virtual void bus_suspend(bool suspended) = 0;
  /// Sends a SETUP transaction to endpoint 0 of the device at `address` (0..127). kNone means that no device is there,
  /// or endpoint 0 is off.
  virtual UsbReply setup(std::uint8_t address, std::span<const std::uint8_t, 8> bytes) = 0;
  /// Sends an OUT transaction; `data1` is the data toggle. kNak: the endpoint has no room, kStall: it is halted, kNone:
  /// nobody answers.
  virtual UsbReply out(std::uint8_t address, std::uint8_t endpoint, bool data1,
                       std::span<const std::uint8_t> bytes) = 0;
  /// Sends an IN transaction, which asks an endpoint for one packet. kNak: it has none, kStall: it is halted, kNone:
  /// nobody answers.
  virtual UsbIn in(std::uint8_t address, std::uint8_t endpoint) = 0;
};

}  // namespace triskin::machine
