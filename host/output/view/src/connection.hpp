// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <atomic>
#include <boost/asio/ip/tcp.hpp>
#include <list>
#include <memory>
#include <string>

#include "gate.hpp"
#include "triskin/view/server.hpp"

namespace triskin::view {

/// A stranger is a connection that has not shown the token yet.
class Stranger {
 public:
  virtual ~Stranger() = default;
  virtual void drop() = 0;
};

/// All connections of one server share this state, which must outlive them. Only the server's thread uses it, except
/// `connections` and `had_page`.
struct Shared {
  Site site;
  const LatestSamples& live;
  Server::OnCommand on_command;
  Server::Limits limits;
  std::string token;
  std::uint16_t port = 0;
  std::atomic<std::size_t> connections{0};
  std::atomic<bool> had_page{false};
  std::size_t known = 0;                           ///< Only open connections that have shown the token count.
  std::list<std::weak_ptr<Stranger>> strangers{};  ///< The oldest one is at the front.

  [[nodiscard]] Gate gate() const { return {port, token}; }
  /// Adds a connection without token. If there are too many, the oldest is closed, so that connections without the
  /// token cannot block those that have it.
  void add_stranger(const std::shared_ptr<Stranger>& stranger);
};

/// Counts a connection while the object exists.
class Counted {
 public:
  explicit Counted(Shared& shared) : shared_(shared) { ++shared_.connections; }
  ~Counted() {
    --shared_.connections;
    if (is_known_) --shared_.known;
  }
  /// Notes that the connection has shown the token. Returns false if too many have, and this one must close.
  [[nodiscard]] bool make_known() {
    if (!is_known_ && shared_.known >= shared_.limits.connections) return false;
    if (!is_known_) ++shared_.known;
    return is_known_ = true;
  }
  [[nodiscard]] bool is_known() const { return is_known_; }
  Counted(const Counted&) = delete;
  Counted& operator=(const Counted&) = delete;

 private:
  Shared& shared_;
  bool is_known_ = false;
};

/// Answers the requests of one connection until it is closed or becomes a live connection.
void serve_http(boost::asio::ip::tcp::socket socket, Shared& shared);

}  // namespace triskin::view
