// SPDX-License-Identifier: GPL-3.0-or-later
#include <arpa/inet.h>
#include <fmt/format.h>
#include <netdb.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <chrono>
#include <cstdint>
#include <cstring>
#include <nlohmann/json.hpp>

#include "triskin/base/error.hpp"
#include "triskin/scenario/contact_stream.hpp"

namespace triskin::scenario {
namespace {

constexpr int kPoll_ms = 100;

class Socket {
 public:
  explicit Socket(int descriptor) : descriptor_(descriptor) {}
  ~Socket() {
    if (descriptor_ >= 0) ::close(descriptor_);
  }
  Socket(const Socket&) = delete;
  Socket& operator=(const Socket&) = delete;
  [[nodiscard]] int descriptor() const { return descriptor_; }
  [[nodiscard]] bool readable() const {
    pollfd p{descriptor_, POLLIN, 0};
    return ::poll(&p, 1, kPoll_ms) > 0;
  }

 private:
  int descriptor_;
};

bool is_of_this_computer(const sockaddr& address) {
  if (address.sa_family == AF_INET6)
    return IN6_IS_ADDR_LOOPBACK(&reinterpret_cast<const sockaddr_in6&>(address).sin6_addr) != 0;
  const std::uint32_t v4 = ntohl(reinterpret_cast<const sockaddr_in&>(address).sin_addr.s_addr);
  return address.sa_family == AF_INET && v4 >> 24 == IN_LOOPBACKNET;
}

int listen_at(const device::HostPort& at) {
  const std::string name = device::host_port_text(at);
  addrinfo hints{}, *found = nullptr;
  hints.ai_socktype = SOCK_STREAM;
  hints.ai_flags = AI_PASSIVE;
  if (const int error = ::getaddrinfo(at.host.c_str(), std::to_string(at.port).c_str(), &hints, &found); error != 0)
    throw DeviceError(fmt::format("{}: cannot find the host: {}", name, ::gai_strerror(error)));
  if (!is_of_this_computer(*found->ai_addr)) {
    ::freeaddrinfo(found);
    throw InputError(
        fmt::format("{}: contacts are taken from this computer only, since nothing asks a client who it is; listen on "
                    "127.0.0.1",
                    name));
  }
  const int listener = ::socket(found->ai_family, found->ai_socktype | SOCK_CLOEXEC, found->ai_protocol);
  const int on = 1;
  if (listener >= 0) (void)::setsockopt(listener, SOL_SOCKET, SO_REUSEADDR, &on, sizeof on);
  const bool ok =
      listener >= 0 && ::bind(listener, found->ai_addr, found->ai_addrlen) == 0 && ::listen(listener, 4) == 0;
  const int error = errno;
  ::freeaddrinfo(found);
  if (ok) return listener;
  if (listener >= 0) ::close(listener);
  throw DeviceError(
      fmt::format("{}: cannot listen: {}; use another port, or 0 for a free one", name, std::strerror(error)));
}

int port_at(int socket) {
  sockaddr_storage address{};
  socklen_t size = sizeof address;
  if (::getsockname(socket, reinterpret_cast<sockaddr*>(&address), &size) != 0) return 0;
  return ntohs(address.ss_family == AF_INET6 ? reinterpret_cast<sockaddr_in6*>(&address)->sin6_port
                                             : reinterpret_cast<sockaddr_in*>(&address)->sin_port);
}

// False: the client is gone.
bool send_line(int socket, const std::string& line) {
  const std::string text = line + '\n';
  for (std::size_t sent = 0; sent < text.size();) {
    const ssize_t n = ::send(socket, text.data() + sent, text.size() - sent, MSG_NOSIGNAL);
    if (n < 0 && errno == EINTR) continue;
    if (n <= 0) return false;
    sent += static_cast<std::size_t>(n);
  }
  return true;
}

// Answers the whole lines of `text` and removes them. False: the client is let go.
bool answer_lines(ContactStream& stream, int socket, std::string& text) {
  try {
    for (std::size_t end = text.find('\n'); end != std::string::npos; end = text.find('\n')) {
      const std::string line = text.substr(0, end);
      text.erase(0, end + 1);
      if (!send_line(socket, stream.take(line))) return false;
    }
    if (text.size() > ContactStream::kMaxLine_bytes)
      throw InputError(fmt::format("contacts: the line is longer than {} bytes; send fewer contacts in a step",
                                   ContactStream::kMaxLine_bytes));
    return true;
  } catch (const InputError& e) {
    (void)send_line(socket,
                    nlohmann::json{{"error", e.what()}}.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace));
    return false;
  }
}

void serve_client(ContactStream& stream, const Socket& client, const std::function<bool()>& ended) {
  if (!send_line(client.descriptor(), stream.greeting())) return;
  std::string text;
  std::array<char, 65'536> chunk;
  while (!ended()) {
    if (!client.readable()) continue;
    const ssize_t n = ::recv(client.descriptor(), chunk.data(), chunk.size(), 0);
    if (n < 0 && errno == EINTR) continue;
    if (n <= 0) return;
    text.append(chunk.data(), static_cast<std::size_t>(n));
    if (!answer_lines(stream, client.descriptor(), text)) return;
  }
}

}  // namespace

void serve_contacts(ContactStream& stream, const device::HostPort& at, const std::atomic<bool>& stop, double seconds,
                    const std::function<void(int port)>& listening) {
  const Socket listener(listen_at(at));
  if (listening) listening(port_at(listener.descriptor()));
  const auto begin = std::chrono::steady_clock::now();
  const auto ended = [&] {
    return stop ||
           (seconds > 0.0 && std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count() > seconds);
  };
  while (!ended()) {
    if (!listener.readable()) continue;
    const Socket client(::accept4(listener.descriptor(), nullptr, nullptr, SOCK_CLOEXEC));
    if (client.descriptor() >= 0) serve_client(stream, client, ended);
  }
}

}  // namespace triskin::scenario
