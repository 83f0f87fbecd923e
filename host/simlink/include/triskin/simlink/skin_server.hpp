// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <atomic>
#include <cstdint>
#include <memory>
#include <string>

#include "triskin/scene/virtual_skin.hpp"

namespace triskin::device {

/// Shows a simulated skin to the outside in real time: virtual time follows the wall clock, and stands still rather
/// than run after it on a computer that is too slow.
class SkinServer {
 public:
  explicit SkinServer(scene::VirtualSkin& skin) : skin_(skin) {}
  virtual ~SkinServer() = default;
  SkinServer(const SkinServer&) = delete;
  SkinServer& operator=(const SkinServer&) = delete;

  /// What `--link` of a client must be.
  [[nodiscard]] virtual std::string link_name() const = 0;
  /// Until `stop` is set or `seconds` have passed (0: for ever).
  void run(const std::atomic<bool>& stop, double seconds);

 protected:
  static constexpr std::uint64_t kStep_us = 1'000;  ///< longest time between two looks outside
  /// Hands out what the skin has sent.
  virtual void flush() = 0;
  /// Waits for somebody outside, at most `timeout_us`, and takes what comes.
  virtual void wait(std::uint64_t timeout_us) = 0;

  scene::VirtualSkin& skin_;
};

/// Serves on `HOST:PORT` (TCP), `can:IFACE` (SocketCAN) or `usb` (a USB device for each controller in this computer's
/// vhci-hcd). Throws InputError, DeviceError.
[[nodiscard]] std::unique_ptr<SkinServer> open_server(scene::VirtualSkin& skin, const std::string& at);

}  // namespace triskin::device
