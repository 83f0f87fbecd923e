// SPDX-License-Identifier: GPL-3.0-or-later
#include "triskin/link/can_socket.hpp"

#include <fmt/format.h>
#include <linux/can.h>
#include <linux/can/error.h>
#include <linux/can/raw.h>
#include <net/if.h>
#include <poll.h>
#include <sys/ioctl.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <cstring>
#include <thread>

#include "triskin/link/link.hpp"
#include "triskin/wire/loader_protocol.hpp"
#include "triskin/wire/log.hpp"
#include "triskin/wire/node_claim.hpp"
#include "triskin/wire/taxel_frames.hpp"
#include "triskin/wire/uds.hpp"

namespace triskin::link {
namespace {

constexpr auto kQueueFull = std::chrono::seconds(1);
constexpr auto kQueueLook = std::chrono::microseconds(500);

canfd_frame to_kernel(const wire::CanFrame& f) {
  canfd_frame k{};
  k.can_id = f.id | (f.extended ? CAN_EFF_FLAG : 0U);
  k.len = f.size;
  k.flags = static_cast<__u8>(f.bit_rate_switch ? CANFD_BRS : 0);
  std::copy_n(f.data.begin(), f.size, k.data);
  return k;
}

wire::CanFrame from_kernel(const canfd_frame& k, bool fd) {
  wire::CanFrame f;
  f.extended = (k.can_id & CAN_EFF_FLAG) != 0;
  f.id = k.can_id & (f.extended ? CAN_EFF_MASK : CAN_SFF_MASK);
  f.fd = fd;
  f.bit_rate_switch = fd && (k.flags & CANFD_BRS) != 0;
  f.size = std::min<std::uint8_t>(k.len, fd ? 64 : 8);
  std::copy_n(k.data, f.size, f.data.begin());
  return f;
}

template <typename T>
bool set_option(int socket, int level, int name, const T& value) {
  return ::setsockopt(socket, level, name, &value, sizeof value) == 0;
}

}  // namespace

CanSocket::CanSocket(const std::string& interface) : interface_(interface) {
  if (interface.empty() || interface.size() >= IFNAMSIZ) {
    throw InputError(fmt::format("link can:{}: give the name of a CAN interface, for example can:can0", interface));
  }
  socket_ = ::socket(PF_CAN, SOCK_RAW | SOCK_CLOEXEC | SOCK_NONBLOCK, CAN_RAW);
  if (socket_ < 0)
    throw DeviceError(fmt::format(
        "can:{}: the kernel has no CAN ({}); load can-raw and the driver of the interface; run: triskin doctor",
        interface, std::strerror(errno)));
  try {
    ifreq request{};
    std::copy(interface.begin(), interface.end(), request.ifr_name);
    if (::ioctl(socket_, SIOCGIFINDEX, &request) != 0) {
      throw Unreachable(
          fmt::format("can:{}: no such interface; \"ip -br link show\" lists them; run: triskin doctor", interface));
    }
    const int index = request.ifr_ifindex;
    if (::ioctl(socket_, SIOCGIFFLAGS, &request) != 0) fail("cannot ask the interface", errno);
    if ((request.ifr_flags & IFF_UP) == 0) fail("", ENETDOWN);
    if (::ioctl(socket_, SIOCGIFMTU, &request) != 0) fail("cannot ask the interface", errno);
    fd_ = request.ifr_mtu >= static_cast<int>(CANFD_MTU);
    const int on = 1;
    const can_err_mask_t errors = CAN_ERR_MASK;
    (void)set_option(socket_, SOL_SOCKET, SO_RXQ_OVFL, on);
    if (fd_ && !set_option(socket_, SOL_CAN_RAW, CAN_RAW_FD_FRAMES, on)) fd_ = false;
    (void)set_option(socket_, SOL_CAN_RAW, CAN_RAW_ERR_FILTER, errors);
    const int buffer_bytes = 4 << 20;  // The buffer holds a stream of 16 patches for a second.
    if (!set_option(socket_, SOL_SOCKET, SO_RCVBUFFORCE, buffer_bytes))
      (void)set_option(socket_, SOL_SOCKET, SO_RCVBUF, buffer_bytes);
    sockaddr_can address{};
    address.can_family = AF_CAN;
    address.can_ifindex = index;
    if (::bind(socket_, reinterpret_cast<sockaddr*>(&address), sizeof address) != 0) fail("cannot be opened", errno);
  } catch (...) {
    ::close(socket_);
    throw;
  }
}

CanSocket::~CanSocket() {
  ::close(socket_);
}

void CanSocket::fail(const std::string& what, int error) {
  alive_ = false;
  if (error == ENETDOWN || error == ENETUNREACH) {
    throw Unreachable(
        fmt::format("can:{}: the interface is down; triskin doctor has the line that brings it up", interface_));
  }
  if (error == ENODEV || error == ENXIO)
    throw Unreachable(fmt::format("can:{}: the interface is gone; plug the adapter in again", interface_));
  throw DeviceError(fmt::format("can:{}: {} ({})", interface_, what, std::strerror(error)));
}

void CanSocket::filter_for_host() {
  constexpr std::uint32_t kAll = CAN_EFF_MASK | CAN_EFF_FLAG | CAN_RTR_FLAG, kAll11 = CAN_EFF_FLAG | CAN_RTR_FLAG;
  const auto wide = [](std::uint32_t id, std::uint32_t free_bits) {
    return can_filter{id | CAN_EFF_FLAG, kAll & ~free_bits};
  };
  const std::array<can_filter, 7> filters{{
      wide(wire::physical_id(wire::kTesterAddress, 0), 0xFF),
      wide(wire::kClaimBase, wire::kClaimMask),
      wide(wire::kFullBase, 0xFFFF),
      wide(wire::kLogBase, 0xFF),
      wide(wire::loader::kReplyId, 0),
      {0x400, kAll11 | 0x700},  // These are the taxels of iCub boards.
      {0x700, kAll11 | 0x700},  // These are their answers in the loader class.
  }};
  (void)set_option(socket_, SOL_CAN_RAW, CAN_RAW_FILTER, filters);
}

void CanSocket::drop_filter() {
  (void)set_option(socket_, SOL_CAN_RAW, CAN_RAW_FILTER, can_filter{0, 0});
}

namespace {

[[noreturn]] void throw_unacknowledged(const std::string& interface) {
  throw Unreachable(fmt::format(
      "can:{}: frames do not leave: nobody acknowledges them; check cable, termination and bit rate", interface));
}

}  // namespace

void CanSocket::send(const wire::CanFrame& frame) {
  if (frame.fd && !fd_) throw DeviceError(fmt::format("can:{}: the interface does not carry FD frames", interface_));
  if (errors_.bus_off) throw Unreachable(trouble());
  const canfd_frame k = to_kernel(frame);
  const std::size_t size = frame.fd ? CANFD_MTU : CAN_MTU;
  const auto start = std::chrono::steady_clock::now();
  while (::write(socket_, &k, size) != static_cast<ssize_t>(size)) {
    const int error = errno;
    if (error == EINTR) continue;
    if (error != ENOBUFS && error != EAGAIN) fail("cannot send", error);
    if (std::chrono::steady_clock::now() - start > kQueueFull) throw_unacknowledged(interface_);
    // SocketCAN does not report when a full device queue has room again, because poll only watches the socket's buffer.
    std::this_thread::sleep_for(kQueueLook);
  }
}

// The kernel reports with each frame how many frames were dropped so far because the queue was full.
ssize_t CanSocket::read_frame(canfd_frame* frame) {
  iovec bytes{frame, sizeof *frame};
  alignas(cmsghdr) std::array<char, CMSG_SPACE(sizeof(std::uint32_t))> control{};
  msghdr message{};
  message.msg_iov = &bytes;
  message.msg_iovlen = 1;
  message.msg_control = control.data();
  message.msg_controllen = control.size();
  const ssize_t n = ::recvmsg(socket_, &message, 0);
  for (cmsghdr* c = n < 0 ? nullptr : CMSG_FIRSTHDR(&message); c != nullptr; c = CMSG_NXTHDR(&message, c)) {
    if (c->cmsg_level == SOL_SOCKET && c->cmsg_type == SO_RXQ_OVFL)
      std::memcpy(&thrown_away_, CMSG_DATA(c), sizeof thrown_away_);
  }
  return n;
}

std::optional<wire::CanFrame> CanSocket::receive() {
  while (true) {
    canfd_frame k{};
    const ssize_t n = read_frame(&k);
    if (n < 0) {
      if (errno == EINTR) continue;
      if (errno == EAGAIN) return std::nullopt;
      fail("cannot receive", errno);
    }
    if (n != static_cast<ssize_t>(CAN_MTU) && n != static_cast<ssize_t>(CANFD_MTU)) continue;
    if ((k.can_id & CAN_ERR_FLAG) != 0) {
      note_error(k.can_id & CAN_ERR_MASK, k.data);
      continue;
    }
    if ((k.can_id & CAN_RTR_FLAG) != 0) continue;
    errors_.unacknowledged = false;
    return from_kernel(k, n == static_cast<ssize_t>(CANFD_MTU));
  }
}

void CanSocket::note_error(std::uint32_t error_class, const std::uint8_t* data) {
  ++errors_.frames;
  if ((error_class & CAN_ERR_BUSOFF) != 0) errors_.bus_off = true;
  if ((error_class & CAN_ERR_RESTARTED) != 0) errors_.bus_off = errors_.passive = false;
  if ((error_class & CAN_ERR_ACK) != 0) errors_.unacknowledged = true;
  if ((error_class & CAN_ERR_CRTL) != 0) {
    constexpr int kBad =
        CAN_ERR_CRTL_RX_WARNING | CAN_ERR_CRTL_TX_WARNING | CAN_ERR_CRTL_RX_PASSIVE | CAN_ERR_CRTL_TX_PASSIVE;
    if ((data[1] & kBad) != 0) errors_.passive = true;
    if ((data[1] & CAN_ERR_CRTL_ACTIVE) != 0) errors_.passive = false;
  }
}

std::string CanSocket::trouble() const {
  if (errors_.bus_off) {
    return fmt::format(
        "can:{0}: bus-off: the interface has left the bus after too many errors; check cable, termination and bit "
        "rate, then: "
        "ip link set {0} type can restart",
        interface_);
  }
  if (errors_.unacknowledged)
    return fmt::format("can:{}: nobody acknowledges frames; check power, cable and bit rate", interface_);
  if (errors_.passive) return fmt::format("can:{}: many bus errors; check termination and bit rate", interface_);
  return {};
}

}  // namespace triskin::link
