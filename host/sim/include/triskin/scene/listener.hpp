// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstdint>
#include <string>

#include "triskin/scene/tcp_link.hpp"

namespace triskin::device {

/// A TCP socket that listens and does not block; whoever has it closes it.
struct Listener {
  int socket = -1;
  std::uint16_t port = 0;   ///< It is the port that was taken, also where a free one was asked for.
  bool is_exposed = false;  ///< Other computers can reach it.
};

/// Listens at `at`; port 0 takes a free one. `refusal` says why other computers may not reach it and what to do; it is
/// empty where they may. Throws InputError with `at` and `refusal` when they could, DeviceError when the host is not
/// found or the address cannot be used.
[[nodiscard]] Listener listen_at(const HostPort& at, const std::string& refusal);

}  // namespace triskin::device
