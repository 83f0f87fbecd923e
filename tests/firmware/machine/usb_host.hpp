// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstdint>
#include <map>
#include <optional>
#include <vector>

#include "triskin/core/bytes.hpp"
#include "triskin/machine/machine.hpp"
#include "triskin/wire/usb_function.hpp"

namespace triskin::machine {

/// Plays the host at the other end of the machine's cable: transfers of packets of 64 bytes with data toggles, retries
/// and time-outs, in virtual time.
class UsbHost {
 public:
  explicit UsbHost(Machine& machine) : machine_(machine) {}

  /// Waits up to a second for a device, resets the bus and assigns the address. Returns false if no device is there.
  bool connect(std::uint8_t address);
  /// Returns nothing if the device refused, or was silent for five seconds.
  std::optional<std::vector<std::uint8_t>> control(const wire::UsbSetup& setup, Bytes data = {});
  /// Returns false if the packet was not taken within 100 ms.
  bool out(std::uint8_t endpoint, Bytes packet);
  /// Returns an empty packet if nothing arrived within `wait_us`.
  std::vector<std::uint8_t> in(std::uint8_t endpoint, std::uint64_t wait_us);
  /// Sends the last packet again, as if its acknowledgement had been lost.
  bool repeat_out(std::uint8_t endpoint, Bytes packet);

  [[nodiscard]] UsbWire& wire() { return machine_.usb(); }
  int toggle_errors = 0;  ///< Packets of the device with the wrong data toggle are counted.

 private:
  UsbReply spend(UsbReply reply, std::size_t bytes);
  UsbReply send(std::uint8_t endpoint, bool data1, Bytes packet, std::uint64_t patience_us);
  UsbIn receive(std::uint8_t endpoint, std::uint64_t patience_us);
  bool begin(const wire::UsbSetup& setup);
  std::optional<std::vector<std::uint8_t>> data_in(std::uint16_t length);

  Machine& machine_;
  std::uint8_t address_ = 0;
  std::map<std::uint8_t, bool> toggle_;  // The key is the end point with its direction.
};

}  // namespace triskin::machine
