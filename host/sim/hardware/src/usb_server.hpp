// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstdint>
#include <deque>
#include <vector>

#include "triskin/hardware/skin_server.hpp"
#include "triskin/wire/usb_function.hpp"

namespace triskin::hardware {

/// The device appears on this computer's virtual USB host controller (vhci-hcd), as if it had been plugged in. It uses
/// USB/IP (Linux, Documentation/usb/usbip_protocol.rst) over a socket pair with the kernel. Non-blocking.
class VhciDevice {
 public:
  /// Plugs the device in; `number` (≥ 0) differs for each device. `function` must outlive it. Throws DeviceError: no
  /// vhci-hcd, no permission to use it, no free port.
  VhciDevice(wire::UsbFunction& function, int number);
  /// Unplugs the device from the virtual controller.
  ~VhciDevice();
  VhciDevice(const VhciDevice&) = delete;
  VhciDevice& operator=(const VhciDevice&) = delete;

  /// Returns the socket for poll(), which the device owns.
  [[nodiscard]] int descriptor() const { return socket_; }
  /// Returns false if the kernel has closed the connection; the device is then useless.
  [[nodiscard]] bool alive() const { return alive_; }
  /// Handles the requests of the kernel that have arrived, without waiting. Returns true if there were some.
  bool read();
  /// Completes waiting transfers with data that the device has, without waiting.
  void write();

 private:
  struct Transfer {
    std::uint32_t number = 0;
    std::uint8_t endpoint = 0;  // The number includes the direction bit.
    std::size_t length = 0;
  };
  bool take_request();
  void submit(Bytes head, Bytes data);
  void unlink(Bytes head);
  void reply(std::uint32_t number, std::int32_t status, Bytes data, std::size_t length);
  void put(Bytes bytes);

  wire::UsbFunction& function_;
  int socket_ = -1;
  bool alive_ = true;
  std::vector<std::uint8_t> in_, out_;
  std::deque<Transfer> waiting_;
};

/// Plugs every controller of a simulated skin into this computer's USB. This needs permission to write to vhci-hcd
/// (root).
class UsbServer final : public SkinServer {
 public:
  /// `skin` must outlive the server. Throws as VhciDevice does.
  explicit UsbServer(hardware::VirtualSkin& skin);
  ~UsbServer() override;
  [[nodiscard]] std::string link_name() const override { return "usb and hid"; }

 private:
  void flush() override;
  void wait(std::uint64_t timeout_us) override;
  void plug(std::size_t controller);

  std::vector<int> sessions_;  // Each controller may come back as another device, which has another session.
  std::vector<std::unique_ptr<VhciDevice>> devices_;
  int plugged_ = 0;  // Each connection gets the next number.
};

}  // namespace triskin::hardware
