// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <netdb.h>

#include <memory>
#include <string>

#include "triskin/hardware/tcp_link.hpp"

namespace triskin::hardware {

/// The addresses of a host are a list.
using ResolvedHost = std::unique_ptr<addrinfo, decltype(&::freeaddrinfo)>;

/// Finds the addresses for a TCP socket; `flags` are those of addrinfo. `name` stands first in the error. Throws
/// DeviceError for an unknown host. Cost: may ask a name server.
[[nodiscard]] ResolvedHost resolve(const HostPort& at, int flags, const std::string& name);

}  // namespace triskin::hardware
