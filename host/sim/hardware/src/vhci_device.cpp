// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "triskin/base/error.hpp"
#include "usb_server.hpp"

namespace triskin::hardware {
namespace {

constexpr std::size_t kHeadBytes = 48;
constexpr std::uint32_t kSubmit = 1, kUnlink = 2, kSubmitReply = 3, kUnlinkReply = 4;
constexpr std::size_t kMaxBytes = 1 << 20;  // A single transfer may not be larger.
constexpr int kFullSpeed = 2, kBus = 1, kFreePort = 4;

constexpr std::size_t kPacket = 64;  // Longer transfers consist of several packets.

// Returns what the device has for a transfer of up to `length` bytes; a short packet ends the data.
std::vector<std::uint8_t> packets_of(wire::UsbFunction& function, std::uint8_t endpoint, std::size_t length) {
  std::vector<std::uint8_t> data;
  std::size_t packet_bytes = kPacket;
  while (packet_bytes == kPacket && (data.empty() || data.size() + kPacket <= length)) {
    const Bytes packet = function.in(endpoint);
    data.insert(data.end(), packet.begin(), packet.end());
    packet_bytes = packet.size();
  }
  return data;
}

// Finds a free port for devices up to high speed; returns the controller's folder and the port number.
std::pair<std::filesystem::path, int> free_port() {
  const std::filesystem::path base = "/sys/devices/platform";
  bool any = false;
  std::error_code error;
  for (const auto& entry : std::filesystem::directory_iterator(base, error)) {
    if (!entry.path().filename().string().starts_with("vhci_hcd")) continue;
    // Folder 0 reports all controllers in status, status.1, …, and ports are numbered consecutively.
    for (const auto& file : std::filesystem::directory_iterator(entry.path(), error)) {
      if (!file.path().filename().string().starts_with("status")) continue;
      any = true;
      std::ifstream status(file.path());
      for (std::string line; std::getline(status, line);) {
        std::istringstream fields(line);
        std::string hub;
        int port = 0, state = 0;
        if (fields >> hub >> port >> state && hub == "hs" && state == kFreePort) return {entry.path(), port};
      }
    }
  }
  throw DeviceError(any ? "usb: all ports of vhci-hcd are taken; unplug some with usbip detach"
                        : "usb: the kernel has no virtual USB host controller; load it: modprobe vhci-hcd");
}

}  // namespace

VhciDevice::VhciDevice(wire::UsbFunction& function, int number) : function_(function) {
  function_.reset();
  const auto [folder, port] = free_port();
  std::array<int, 2> pair{};
  if (::socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, pair.data()) != 0)
    throw DeviceError(fmt::format("usb: no socket: {}", std::strerror(errno)));
  std::ofstream attach(folder / "attach");
  attach << port << ' ' << pair[1] << ' ' << (kBus << 16 | number) << ' ' << kFullSpeed << std::flush;
  const bool ok = attach.good();
  ::close(pair[1]);
  if (!ok) {
    ::close(pair[0]);
    throw DeviceError("usb: cannot plug a device into vhci-hcd; run as root");
  }
  socket_ = pair[0];
}

VhciDevice::~VhciDevice() {
  ::close(socket_);
}

bool VhciDevice::read() {
  std::array<std::uint8_t, 16'384> chunk{};
  bool came = false;
  while (alive_) {
    const ssize_t n = ::recv(socket_, chunk.data(), chunk.size(), MSG_DONTWAIT);
    if (n < 0 && errno == EINTR) continue;
    if (n < 0 && (errno == EAGAIN || errno == EWOULDBLOCK)) break;
    if (n <= 0) {
      alive_ = false;
      break;
    }
    came = true;
    in_.insert(in_.end(), chunk.begin(), chunk.begin() + n);
  }
  while (alive_ && take_request()) {
  }
  return came;
}

bool VhciDevice::take_request() {
  if (in_.size() < kHeadBytes) return false;
  const Bytes head = Bytes(in_).first(kHeadBytes);
  ByteReader r(head);
  const std::uint32_t command = r.be32();
  std::size_t data_bytes = 0;
  if (command == kSubmit) {
    const bool to_device = ByteReader(head.subspan(12)).be32() == 0;
    const std::size_t length = ByteReader(head.subspan(24)).be32();
    if (length > kMaxBytes) alive_ = false;
    if (to_device) data_bytes = length;
  } else if (command != kUnlink) {
    alive_ = false;
  }
  if (!alive_ || in_.size() < kHeadBytes + data_bytes) return false;
  if (command == kSubmit)
    submit(head, Bytes(in_).subspan(kHeadBytes, data_bytes));
  else
    unlink(head);
  in_.erase(in_.begin(), in_.begin() + static_cast<std::ptrdiff_t>(kHeadBytes + data_bytes));
  return true;
}

void VhciDevice::submit(Bytes head, Bytes data) {
  ByteReader r(head.subspan(4));
  const std::uint32_t number = r.be32();
  (void)r.be32();
  const bool in = r.be32() == 1;
  const std::uint32_t endpoint = r.be32();
  (void)r.be32();
  const std::size_t length = r.be32();
  if (endpoint == 0) {
    const wire::UsbSetup setup = wire::setup_of(head.subspan(40));
    const auto answer = function_.control(setup, data);
    if (!answer) return reply(number, -EPIPE, {}, 0);
    const Bytes sent = in ? answer->first(std::min({answer->size(), length, std::size_t{setup.length}})) : Bytes{};
    return reply(number, 0, sent, in ? sent.size() : length);
  }
  if (in) {
    waiting_.push_back({number, static_cast<std::uint8_t>(0x80 | endpoint), length});
    return;
  }
  for (std::size_t at = 0; at < data.size(); at += kPacket) {
    function_.out(static_cast<std::uint8_t>(endpoint), data.subspan(at, std::min(kPacket, data.size() - at)));
  }
  reply(number, 0, {}, data.size());
}

void VhciDevice::unlink(Bytes head) {
  const std::uint32_t number = ByteReader(head.subspan(4)).be32(), victim = ByteReader(head.subspan(20)).be32();
  const auto found = std::ranges::find(waiting_, victim, &Transfer::number);
  const bool hit = found != waiting_.end();
  if (hit) waiting_.erase(found);
  std::array<std::uint8_t, kHeadBytes> bytes{};
  ByteWriter w(bytes);
  w.be32(kUnlinkReply);
  w.be32(number);
  for (int k = 0; k < 3; ++k) w.be32(0);
  w.be32(static_cast<std::uint32_t>(hit ? -ECONNRESET : 0));
  put(bytes);
}

void VhciDevice::reply(std::uint32_t number, std::int32_t status, Bytes data, std::size_t length) {
  std::array<std::uint8_t, kHeadBytes> bytes{};
  ByteWriter w(bytes);
  w.be32(kSubmitReply);
  w.be32(number);
  for (int k = 0; k < 3; ++k) w.be32(0);
  w.be32(static_cast<std::uint32_t>(status));
  w.be32(static_cast<std::uint32_t>(length));
  put(bytes);
  put(data);
}

void VhciDevice::put(Bytes bytes) {
  out_.insert(out_.end(), bytes.begin(), bytes.end());
}

void VhciDevice::write() {
  for (auto t = waiting_.begin(); t != waiting_.end();) {
    const std::vector<std::uint8_t> data = packets_of(function_, t->endpoint, t->length);
    if (data.empty()) {
      ++t;
      continue;
    }
    reply(t->number, 0, Bytes(data).first(std::min(data.size(), t->length)), std::min(data.size(), t->length));
    t = waiting_.erase(t);
  }
  while (alive_ && !out_.empty()) {
    const ssize_t n = ::send(socket_, out_.data(), out_.size(), MSG_DONTWAIT | MSG_NOSIGNAL);
    if (n < 0 && errno == EINTR) continue;
    if (n < 0 && (errno == EAGAIN || errno == EWOULDBLOCK)) break;
    if (n <= 0) {
      alive_ = false;
      break;
    }
    out_.erase(out_.begin(), out_.begin() + n);
  }
}

}  // namespace triskin::hardware
