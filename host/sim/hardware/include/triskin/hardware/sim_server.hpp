// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <chrono>
#include <vector>

#include "triskin/hardware/skin_server.hpp"
#include "triskin/hardware/tcp_link.hpp"

namespace triskin::hardware {

/// Serves a simulated skin over TCP. All clients share one bus; a client that sends a malformed record is disconnected.
class SimServer final : public SkinServer {
 public:
  /// Listens at `at`; port 0 uses a free one. `skin` must outlive the server. Throws InputError when other computers
  /// could reach the address but `reach` does not allow it, DeviceError when it cannot be used.
  SimServer(hardware::VirtualSkin& skin, const HostPort& at, Reach reach = Reach::kThisComputer);
  ~SimServer() override;

  /// Returns the port that it listens on.
  [[nodiscard]] std::uint16_t port() const { return port_; }
  [[nodiscard]] std::string link_name() const override { return "sim:" + host_port_text({host_, port_}); }
  /// Returns true if other computers can reach the server, which does not authenticate clients.
  [[nodiscard]] bool is_exposed() const override { return is_exposed_; }

 private:
  struct Client {
    int socket = -1;
    std::vector<std::uint8_t> in, out;
    int touch = 0;
    bool dead = false;
  };
  static constexpr std::size_t kMaxBacklogBytes = std::size_t{4} * 1024 * 1024;

  void flush() override;
  void wait(std::uint64_t timeout_us) override;
  void accept_client();
  void read_client(Client& client);
  void write_client(Client& client);
  void handle(Client& client, const record::Record& record);
  void pressurize(const record::Record& record);
  void drop_dead();

  std::string host_;
  int listener_ = -1;
  std::uint16_t port_ = 0;
  bool is_exposed_ = false;
  std::vector<Client> clients_;
  std::chrono::steady_clock::time_point listens_from_{};  // No connection is accepted before this time.
};

}  // namespace triskin::hardware
