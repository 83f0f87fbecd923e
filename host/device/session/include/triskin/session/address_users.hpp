// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstdint>
#include <map>
#include <span>
#include <vector>

#include "triskin/session/bus.hpp"

namespace triskin::session {

/// Counts the controllers at each node address that is in use. Cost: O(n log n).
[[nodiscard]] inline std::map<std::uint8_t, int> users_of_addresses(std::span<const wire::NodeClaim> claims) {
  std::map<std::uint8_t, int> users;
  for (const wire::NodeClaim& c : claims) ++users[c.node_address];
  return users;
}

/// Returns the addresses that belong to exactly one controller, so that it can be asked; ascending.
[[nodiscard]] inline std::vector<std::uint8_t> lone_addresses(const std::vector<wire::NodeClaim>& claims) {
  std::vector<std::uint8_t> lone;
  for (const auto& [node, count] : users_of_addresses(claims)) {
    if (count == 1) lone.push_back(node);
  }
  return lone;
}

}  // namespace triskin::session
