// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <atomic>
#include <cstdint>
#include <memory>
#include <string>

#include "triskin/hardware/virtual_skin.hpp"

namespace triskin::hardware {

/// Clients may connect from these computers.
enum class Reach {
  kThisComputer,  ///< Only loopback addresses are allowed.
  /// Any address is allowed. Clients are not authenticated: whoever reaches the port may read, press and flash.
  kOtherComputers
};

/// Serves a simulated skin to other programs in real time. Virtual time follows the wall clock; on a computer that is
/// too slow it falls behind and does not catch up. Threads: one, which run() occupies.
class SkinServer {
 public:
  /// `skin` must outlive the server.
  explicit SkinServer(hardware::VirtualSkin& skin) : skin_(skin) {}
  virtual ~SkinServer() = default;
  SkinServer(const SkinServer&) = delete;
  SkinServer& operator=(const SkinServer&) = delete;

  /// Returns the value of `--link` for a client.
  [[nodiscard]] virtual std::string link_name() const = 0;
  /// Returns true if clients on other computers can reach it.
  [[nodiscard]] virtual bool is_exposed() const { return false; }
  /// Serves until `stop` is set or `seconds` of wall time have passed (0: no limit). Throws DeviceError when the
  /// transport fails.
  void run(const std::atomic<bool>& stop, double seconds);

 protected:
  static constexpr std::uint64_t kStep_us = 1'000;  ///< Two calls of wait() are at most this far apart.
  /// Sends the skin's pending frames to the clients.
  virtual void flush() = 0;
  /// Waits for clients, at most `timeout_us`, and receives from them.
  virtual void wait(std::uint64_t timeout_us) = 0;

  hardware::VirtualSkin& skin_;
};

/// Opens a server on `HOST:PORT` (TCP), `can:IFACE` (SocketCAN) or `usb` (a USB device for each controller in this
/// computer's vhci-hcd). `skin` must outlive it. Throws InputError when `at` is none of these or `reach` does not allow
/// it, DeviceError when it cannot be opened.
[[nodiscard]] std::unique_ptr<SkinServer> open_server(hardware::VirtualSkin& skin, const std::string& at,
                                                      Reach reach = Reach::kThisComputer);

}  // namespace triskin::hardware
