// SPDX-License-Identifier: GPL-3.0-or-later
#include "address_moves.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "triskin/session/controller.hpp"

namespace triskin::deploy {
namespace {

constexpr std::uint64_t kRestart_us = 20'000;  // A controller restarts under its new address within this time.

// Assignments are not confirmed, and their frames or the claims after them may be lost.
constexpr int kAssignRounds = 5;

}  // namespace

std::vector<wire::NodeClaim> assign_addresses(session::Bus& bus, std::map<wire::UniqueId, int> wanted) {
  std::vector<wire::NodeClaim> claims;
  for (int round = 0; round < kAssignRounds && !wanted.empty(); ++round) {
    for (const auto& [id, address] : wanted) bus.assign(id, static_cast<std::uint8_t>(address));
    bus.listen(bus.now_us() + kRestart_us);
    // Discovering also teaches a link of several wires which wire leads to which address.
    claims = bus.discover();
    for (const wire::NodeClaim& c : claims) {
      const auto board = wanted.find(c.unique_id);
      if (board != wanted.end() && board->second == c.node_address) wanted.erase(board);
    }
  }
  if (wanted.empty()) return claims;
  const auto& [id, address] = *wanted.begin();
  throw DeviceError(
      fmt::format("{}: controller {} does not say that it has taken node address {}; check its power and the cable, "
                  "then run the command again; nothing was written",
                  bus.name(), session::to_text(id), address));
}

}  // namespace triskin::deploy
