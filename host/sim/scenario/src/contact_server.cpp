// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <chrono>
#include <nlohmann/json.hpp>

#include "triskin/base/error.hpp"
#include "triskin/hardware/listener.hpp"
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

constexpr const char* kRefusal =
    "contacts are taken from this computer only, since nothing asks a client who it is; listen on 127.0.0.1";

// Returns false if the client has disconnected.
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

// Answers the whole lines of `text` and removes them. Returns false if the client must be disconnected.
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

void serve_contacts(ContactStream& stream, const hardware::HostPort& at, const std::atomic<bool>& stop, double seconds,
                    const std::function<void(int port)>& listening) {
  const hardware::Listener place = hardware::listen_at(at, kRefusal);
  const Socket listener(place.socket);
  if (listening) listening(place.port);
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
