// SPDX-License-Identifier: GPL-3.0-or-later
#include "triskin/link/can_channel.hpp"

#include <fmt/format.h>
#include <linux/can.h>
#include <linux/can/isotp.h>
#include <net/if.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstring>

#include "triskin/base/error.hpp"
#include "triskin/wire/iso_tp.hpp"

namespace triskin::link {
namespace {

template <typename T>
bool set_option(int socket, int name, const T& value) {
  return ::setsockopt(socket, SOL_CAN_ISOTP, name, &value, sizeof value) == 0;
}

bool configure(int socket, bool fd) {
  can_isotp_options options{};
  options.flags = CAN_ISOTP_TX_PADDING;
  options.txpad_content = wire::IsoTp::kPadding;
  if (!set_option(socket, CAN_ISOTP_OPTS, options)) return false;
  can_isotp_fc_options flow{};  // The zeros ask for neither pauses nor blocks, because this computer is fast enough.
  if (!set_option(socket, CAN_ISOTP_RECV_FC, flow)) return false;
  if (!fd) return true;
  can_isotp_ll_options frames{};
  frames.mtu = CANFD_MTU;
  frames.tx_dl = CANFD_MAX_DLEN;
  frames.tx_flags = CANFD_BRS;
  return set_option(socket, CAN_ISOTP_LL_OPTS, frames);
}

}  // namespace

std::unique_ptr<CanChannel> CanChannel::open(const std::string& interface, bool fd, std::uint32_t tx_id,
                                             std::uint32_t rx_id) {
  const int socket = ::socket(PF_CAN, SOCK_DGRAM | SOCK_CLOEXEC | SOCK_NONBLOCK, CAN_ISOTP);
  if (socket < 0) return nullptr;
  std::unique_ptr<CanChannel> channel(new CanChannel(socket));
  sockaddr_can address{};
  address.can_family = AF_CAN;
  address.can_ifindex = static_cast<int>(::if_nametoindex(interface.c_str()));
  address.can_addr.tp.tx_id = tx_id | CAN_EFF_FLAG;
  address.can_addr.tp.rx_id = rx_id | CAN_EFF_FLAG;
  if (!configure(socket, fd)) return nullptr;
  if (::bind(socket, reinterpret_cast<sockaddr*>(&address), sizeof address) != 0) {
    throw DeviceError(fmt::format("can:{}: ISO-TP of the kernel cannot be used ({})", interface, std::strerror(errno)));
  }
  return channel;
}

CanChannel::~CanChannel() {
  ::close(socket_);
}

bool CanChannel::send(Bytes message) {
  ssize_t n = 0;
  do {
    n = ::write(socket_, message.data(), message.size());
  } while (n < 0 && errno == EINTR);
  return n == static_cast<ssize_t>(message.size());
}

MessageChannel::Arrival CanChannel::take(std::vector<std::uint8_t>& message) {
  std::array<std::uint8_t, wire::IsoTp::kCapacity + 1> bytes{};
  const ssize_t n = ::read(socket_, bytes.data(), bytes.size());
  if (n < 0) return errno == EAGAIN || errno == EINTR ? Arrival::kNothing : Arrival::kFailed;
  if (n == 0 || static_cast<std::size_t>(n) > wire::IsoTp::kCapacity) return Arrival::kFailed;
  message.assign(bytes.begin(), bytes.begin() + n);
  return Arrival::kMessage;
}

}  // namespace triskin::link
