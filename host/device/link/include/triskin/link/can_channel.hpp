// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstdint>
#include <memory>
#include <string>

#include "triskin/link/link.hpp"

namespace triskin::link {

/// The Linux kernel (module can-isotp) provides this ISO 15765-2 connection, with 29-bit identifiers and padding.
/// Threads: one.
class CanChannel final : public MessageChannel {
 public:
  /// Opens a connection on `interface` (for example "can0") that sends with `tx_id` and receives `rx_id`; `fd` selects
  /// FD frames of 64 bytes. Returns null when the kernel has no ISO-TP. Throws DeviceError when it has, but the
  /// interface cannot be used.
  [[nodiscard]] static std::unique_ptr<CanChannel> open(const std::string& interface, bool fd, std::uint32_t tx_id,
                                                        std::uint32_t rx_id);
  /// Closes the connection; waits for at most 1 s while a message is still being sent.
  ~CanChannel() override;
  CanChannel(const CanChannel&) = delete;
  CanChannel& operator=(const CanChannel&) = delete;

  bool send(Bytes message) override;
  Arrival take(std::vector<std::uint8_t>& message) override;
  /// Returns the file descriptor for poll(), which the channel owns.
  [[nodiscard]] int descriptor() const { return socket_; }

 private:
  explicit CanChannel(int socket) : socket_(socket) {}
  int socket_;
};

}  // namespace triskin::link
