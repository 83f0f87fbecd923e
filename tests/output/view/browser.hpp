// SPDX-License-Identifier: GPL-3.0-or-later
// Acts as a browser: a client that is free to break every rule, and a page that reads the live skin.
#pragma once
#include <arpa/inet.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <cstdint>
#include <optional>
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

/// Finds the address that `triskin view` printed; empty if there is none.
inline std::string page_address(const std::string& printed) {
  const std::size_t at = printed.find("http://");
  return at == std::string::npos ? "" : printed.substr(at, printed.find_first_of("\r\n", at) - at);
}

/// Reads the live skin like a page in a browser.
class LivePage {
 public:
  static constexpr int kText = 1, kBinary = 2;
  struct Message {
    int opcode = 0;
    std::string payload;
  };

  /// `address` is "http://127.0.0.1:PORT/TOKEN/". Throws if the server opens no WebSocket.
  explicit LivePage(const std::string& address)
      : host_(address.substr(7, address.find('/', 7) - 7)),
        client_(static_cast<std::uint16_t>(std::stoi(host_.substr(host_.find(':') + 1)))) {
    client_.send("GET " + address.substr(address.find('/', 7)) + "live HTTP/1.1\r\nHost: " + host_ +
                 "\r\nOrigin: http://" + host_ +
                 "\r\nUpgrade: websocket\r\nConnection: Upgrade\r\nSec-WebSocket-Version: 13\r\n"
                 "Sec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\n\r\n");
    if (!client_.read_to("\r\n\r\n").starts_with("HTTP/1.1 101")) throw std::runtime_error("no WebSocket");
  }

  /// Reads one message; nothing if five seconds pass without a byte.
  std::optional<Message> next() {
    const std::string head = client_.read(2);
    if (head.size() < 2) return std::nullopt;
    std::size_t size = static_cast<unsigned char>(head[1]);
    const std::size_t more = size == 126 ? 2 : size == 127 ? 8 : 0;
    if (more > 0) size = 0;
    for (const char c : client_.read(more)) size = size << 8 | static_cast<unsigned char>(c);
    Message message{static_cast<unsigned char>(head[0]) & 0xF, client_.read(size)};
    if (message.payload.size() < size) return std::nullopt;
    return message;
  }
  /// Reads messages until `count` frames with samples have arrived; returns false if five seconds pass without a byte.
  bool gets_frames(int count) {
    while (count > 0) {
      const auto message = next();
      if (!message) return false;
      if (message->opcode == kBinary) --count;
    }
    return true;
  }
  /// Reads messages until a text contains `part`; returns it, or empty if five seconds pass without a byte or `most`
  /// messages had no such text.
  std::string text_with(const std::string& part, int most = 2000) {
    for (; most > 0; --most) {
      const auto message = next();
      if (!message) return {};
      if (message->opcode == kText && message->payload.find(part) != std::string::npos) return message->payload;
    }
    return {};
  }

 private:
  std::string host_;
  RawClient client_;
};

}  // namespace triskin::test
