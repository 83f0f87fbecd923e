// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <atomic>
#include <functional>
#include <vector>

#include "triskin/device/tcp_link.hpp"
#include "triskin/scene/virtual_skin.hpp"

namespace triskin::device {

/// Serves a simulated skin over TCP, in real time: virtual time follows the wall clock. All clients share one bus.
class SimServer {
 public:
  /// Listens; port 0 takes a free one. Throws DeviceError when the address cannot be used.
  SimServer(scene::VirtualSkin& skin, const HostPort& at);
  ~SimServer();
  SimServer(const SimServer&) = delete;
  SimServer& operator=(const SimServer&) = delete;

  [[nodiscard]] std::uint16_t port() const { return port_; }
  /// Until `stop` is set or `seconds` have passed (0: for ever). A client that sends nonsense is dropped.
  void run(const std::atomic<bool>& stop, double seconds);

 private:
  struct Client {
    int socket = -1;
    std::vector<std::uint8_t> in, out;
    int touch = 0;
    bool dead = false;
  };
  static constexpr std::size_t kMaxBacklogBytes = std::size_t{4} * 1024 * 1024;

  void wait(std::uint64_t timeout_us);
  void accept_client();
  void read_client(Client& client);
  void write_client(Client& client);
  void handle(Client& client, const record::Record& record);
  void drop_dead();

  scene::VirtualSkin& skin_;
  int listener_ = -1;
  std::uint16_t port_ = 0;
  std::vector<Client> clients_;
};

}  // namespace triskin::device
