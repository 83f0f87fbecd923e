// SPDX-License-Identifier: GPL-3.0-or-later
#include "triskin/hardware/listener.hpp"

#include <fmt/format.h>
#include <netdb.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <memory>

#include "resolved_host.hpp"
#include "triskin/base/error.hpp"

namespace triskin::hardware {
namespace {

std::uint16_t port_of(int socket) {
  sockaddr_storage address{};
  socklen_t size = sizeof address;
  if (::getsockname(socket, reinterpret_cast<sockaddr*>(&address), &size) != 0) return 0;
  return ntohs(address.ss_family == AF_INET6 ? reinterpret_cast<sockaddr_in6*>(&address)->sin6_port
                                             : reinterpret_cast<sockaddr_in*>(&address)->sin_port);
}

bool is_loopback(const sockaddr& address) {
  if (address.sa_family == AF_INET6) {
    const in6_addr& v6 = reinterpret_cast<const sockaddr_in6&>(address).sin6_addr;
    const bool is_mapped = IN6_IS_ADDR_V4MAPPED(&v6) && v6.s6_addr[12] == IN_LOOPBACKNET;
    return IN6_IS_ADDR_LOOPBACK(&v6) || is_mapped;
  }
  const std::uint32_t v4 = ntohl(reinterpret_cast<const sockaddr_in&>(address).sin_addr.s_addr);
  return address.sa_family == AF_INET && v4 >> 24 == IN_LOOPBACKNET;
}

}  // namespace

ResolvedHost resolve(const HostPort& at, int flags, const std::string& name) {
  addrinfo hints{}, *first = nullptr;
  hints.ai_socktype = SOCK_STREAM;
  hints.ai_flags = flags;
  if (const int error = ::getaddrinfo(at.host.c_str(), std::to_string(at.port).c_str(), &hints, &first); error != 0)
    throw DeviceError(fmt::format("{}: cannot find the host: {}", name, ::gai_strerror(error)));
  return {first, &::freeaddrinfo};
}

Listener listen_at(const HostPort& at, const std::string& refusal) {
  constexpr int kBacklog = 8;
  const std::string name = host_port_text(at);
  const ResolvedHost found = resolve(at, AI_PASSIVE, name);
  Listener listener;
  listener.is_exposed = !is_loopback(*found->ai_addr);
  if (listener.is_exposed && !refusal.empty()) throw InputError(fmt::format("{}: {}", name, refusal));
  listener.socket = ::socket(found->ai_family, found->ai_socktype | SOCK_CLOEXEC | SOCK_NONBLOCK, found->ai_protocol);
  const int on = 1;
  if (listener.socket >= 0) (void)::setsockopt(listener.socket, SOL_SOCKET, SO_REUSEADDR, &on, sizeof on);
  if (listener.socket < 0 || ::bind(listener.socket, found->ai_addr, found->ai_addrlen) != 0 ||
      ::listen(listener.socket, kBacklog) != 0) {
    const int error = errno;
    if (listener.socket >= 0) ::close(listener.socket);
    throw DeviceError(
        fmt::format("{}: cannot listen: {}; use another port, or 0 for a free one", name, std::strerror(error)));
  }
  listener.port = port_of(listener.socket);
  return listener;
}

}  // namespace triskin::hardware
