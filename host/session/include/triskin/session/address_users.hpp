// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstdint>
#include <map>
#include <span>
#include <vector>

#include "triskin/session/bus.hpp"

namespace triskin::device {

/// How many controllers have each node address that one has. Cost: O(n log n).
[[nodiscard]] inline std::map<std::uint8_t, int> users_of_addresses(std::span<const wire::NodeClaim> claims) {
  std::map<std::uint8_t, int> users;
  for (const wire::NodeClaim& c : claims) ++users[c.node_address];
  return users;
}

/// Addresses of the controllers that can be asked: each alone at its own. Ascending.
[[nodiscard]] inline std::vector<std::uint8_t> lone_addresses(const std::vector<wire::NodeClaim>& claims) {
  std::vector<std::uint8_t> lone;
  for (const auto& [node, count] : users_of_addresses(claims)) {
    if (count == 1) lone.push_back(node);
  }
  return lone;
}

}  // namespace triskin::device
