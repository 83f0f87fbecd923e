// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "triskin/hardware/skin_server.hpp"
#include "triskin/link/can_socket.hpp"

namespace triskin::hardware {

/// Connects the controllers of a simulated skin to a CAN bus of this computer, where any CAN program can talk to them.
class CanServer final : public SkinServer {
 public:
  /// Opens `interface`, for example "vcan0"; `skin` must outlive the server. Throws DeviceError as CanSocket does.
  CanServer(hardware::VirtualSkin& skin, const std::string& interface);
  ~CanServer() override;
  [[nodiscard]] std::string link_name() const override { return name_; }

 private:
  void flush() override {}
  void wait(std::uint64_t timeout_us) override;

  std::string name_;
  link::CanSocket socket_;
};

}  // namespace triskin::hardware
