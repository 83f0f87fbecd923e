// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstdint>
#include <memory>
#include <string>

#include "triskin/link/link.hpp"

namespace triskin::device {

/// An ISO 15765-2 connection that the Linux kernel keeps (module can-isotp), with 29-bit identifiers and padding.
class CanChannel final : public MessageChannel {
 public:
  /// Null when the kernel has no ISO-TP. Throws DeviceError when it has, and the interface cannot be used.
  [[nodiscard]] static std::unique_ptr<CanChannel> open(const std::string& interface, bool fd, std::uint32_t tx_id,
                                                        std::uint32_t rx_id);
  /// Waits for at most a second while a message that nobody takes is under way.
  ~CanChannel() override;
  CanChannel(const CanChannel&) = delete;
  CanChannel& operator=(const CanChannel&) = delete;

  bool send(Bytes message) override;
  Arrival take(std::vector<std::uint8_t>& message) override;
  [[nodiscard]] int descriptor() const { return socket_; }

 private:
  explicit CanChannel(int socket) : socket_(socket) {}
  int socket_;
};

}  // namespace triskin::device
