// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstdint>
#include <string>

#include "triskin/hardware/tcp_link.hpp"

namespace triskin::hardware {

/// The TCP socket listens without blocking; its owner must close it.
struct Listener {
  int socket = -1;
  std::uint16_t port = 0;   ///< If a free port was requested, this is the port that was chosen.
  bool is_exposed = false;  ///< True means that other computers can reach the socket.
};

/// Listens at `at`; port 0 uses a free one. `refusal` says why other computers may not reach it and what to do; it is
/// empty if they may. Throws InputError with `at` and `refusal` when they could, DeviceError when the host is not found
/// or the address cannot be used.
[[nodiscard]] Listener listen_at(const HostPort& at, const std::string& refusal);

}  // namespace triskin::hardware
