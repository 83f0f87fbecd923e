// SPDX-License-Identifier: GPL-3.0-or-later
// Acts as a client that is free to break every rule: it writes bytes and reads bytes.
#pragma once
#include <arpa/inet.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <cstdint>
#include <stdexcept>
#include <string>

namespace triskin::test {

class RawClient {
 public:
  /// Connects to 127.0.0.1. `receive_bytes` sets the size of the kernel's receive buffer; 0 leaves it unchanged.
  explicit RawClient(std::uint16_t port, int receive_bytes = 0) : fd_(::socket(AF_INET, SOCK_STREAM, 0)) {
    if (receive_bytes > 0) ::setsockopt(fd_, SOL_SOCKET, SO_RCVBUF, &receive_bytes, sizeof receive_bytes);
    sockaddr_in to{};
    to.sin_family = AF_INET;
    to.sin_port = htons(port);
    to.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    if (::connect(fd_, reinterpret_cast<const sockaddr*>(&to), sizeof to) != 0) throw std::runtime_error("connect");
  }
  ~RawClient() { ::close(fd_); }
  RawClient(const RawClient&) = delete;
  RawClient& operator=(const RawClient&) = delete;

  void send(const std::string& bytes) const { (void)::send(fd_, bytes.data(), bytes.size(), MSG_NOSIGNAL); }

  /// Reads until `size` bytes have arrived, the server closes, or nothing arrives for `patience_ms`.
  std::string read(std::size_t size, int patience_ms = 5000) {
    while (pending_.size() < size && fill(patience_ms)) {
    }
    return take(size);
  }
  /// Reads until `mark` arrives; the answer includes the mark.
  std::string read_to(const std::string& mark) {
    while (pending_.find(mark) == std::string::npos && fill(5000)) {
    }
    const std::size_t at = pending_.find(mark);
    return take(at == std::string::npos ? pending_.size() : at + mark.size());
  }
  /// Returns true when the server closes the connection before `patience_ms` pass without a byte.
  bool is_closed_by_server(int patience_ms = 8000) {
    while (fill(patience_ms)) pending_.clear();
    return closed_;
  }

 private:
  std::string take(std::size_t size) {
    const std::string bytes = pending_.substr(0, size);
    pending_.erase(0, bytes.size());
    return bytes;
  }
  bool fill(int patience_ms) {
    pollfd ready{fd_, POLLIN, 0};
    if (closed_ || ::poll(&ready, 1, patience_ms) <= 0) return false;
    std::array<char, 65536> bytes{};
    const ssize_t got = ::recv(fd_, bytes.data(), bytes.size(), 0);
    closed_ = got <= 0;
    if (!closed_) pending_.append(bytes.data(), static_cast<std::size_t>(got));
    return !closed_;
  }

  int fd_;
  bool closed_ = false;
  std::string pending_;
};

/// Makes a WebSocket frame like a browser's: masked with zeros. `opcode`: 1 text, 2 binary, 8 close; at most 65535
/// bytes.
inline std::string masked_frame(int opcode, const std::string& payload) {
  std::string frame(1, static_cast<char>(0x80 | opcode));
  if (payload.size() < 126) {
    frame += static_cast<char>(0x80 | payload.size());
  } else {
    frame += static_cast<char>(0x80 | 126);
    frame += static_cast<char>(payload.size() >> 8);
    frame += static_cast<char>(payload.size() & 0xFF);
  }
  return frame + std::string(4, '\0') + payload;
}

}  // namespace triskin::test
