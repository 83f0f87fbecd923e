// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <atomic>
#include <boost/asio/ip/tcp.hpp>
#include <string>

#include "gate.hpp"
#include "triskin/view/server.hpp"

namespace triskin::view {

/// What the connections of one server share. It outlives them. Threads: the server's, but for `connections`.
struct Shared {
  Site site;
  const LiveSkin& live;
  Server::OnCommand on_command;
  Server::Limits limits;
  std::string token;
  std::uint16_t port = 0;
  std::atomic<std::size_t> connections{0};

  [[nodiscard]] Gate gate() const { return {port, token}; }
};

/// Counts a connection while it lives.
class Counted {
 public:
  explicit Counted(Shared& shared) : shared_(shared) { ++shared_.connections; }
  ~Counted() { --shared_.connections; }
  Counted(const Counted&) = delete;
  Counted& operator=(const Counted&) = delete;

 private:
  Shared& shared_;
};

/// Answers the requests of one connection until it is closed or becomes a live connection.
void serve_http(boost::asio::ip::tcp::socket socket, Shared& shared);

}  // namespace triskin::view
