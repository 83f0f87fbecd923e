// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <chrono>
#include <memory>
#include <set>

#include "triskin/link/can_channel.hpp"
#include "triskin/link/can_socket.hpp"
#include "triskin/link/link.hpp"
#include "triskin/wire/bus_load.hpp"

namespace triskin::link {

/// Controllers on a CAN bus of this computer (SocketCAN). It uses FD frames if the interface supports them, and the
/// kernel's ISO-TP if its module is loaded.
class CanLink final : public Link {
 public:
  /// Opens `interface`, for example "can0". Throws DeviceError as CanSocket does.
  explicit CanLink(const std::string& interface);

  void send(const wire::CanFrame& frame) override { socket_->send(frame); }
  std::optional<wire::CanFrame> receive(std::uint64_t until_us) override;
  [[nodiscard]] std::uint64_t now_us() const override;
  [[nodiscard]] bool fd() const override { return socket_->fd(); }
  /// The limit of 1 s exists because the delays of a busy computer exceed those of the controller.
  [[nodiscard]] std::uint64_t answer_us() const override { return 1'000'000; }
  [[nodiscard]] std::string name() const override { return name_; }
  [[nodiscard]] std::string trouble() const override { return socket_->trouble(); }
  void receive_from_all() override { socket_->drop_filter(); }
  [[nodiscard]] std::unique_ptr<MessageChannel> open_channel(std::uint32_t tx_id, std::uint32_t rx_id) override;
  [[nodiscard]] std::uint64_t sample_ns(std::uint8_t) const override {
    return fd() ? wire::full_sample_ns(wire::kControllerRates) : 0;
  }
  [[nodiscard]] std::uint64_t thrown_away() const override { return socket_->thrown_away(); }
  void reconnect() override;

 private:
  class Channel;
  std::unique_ptr<CanSocket> open() const;
  /// Waits until a frame or a message of a channel has arrived, or `wait_us` have passed; returns true if a channel has
  /// data.
  [[nodiscard]] bool wait(std::uint64_t wait_us) const;

  std::string interface_, name_;
  std::unique_ptr<CanSocket> socket_;
  std::set<int> channels_;
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

}  // namespace triskin::link
