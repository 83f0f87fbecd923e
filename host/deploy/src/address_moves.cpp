// SPDX-License-Identifier: GPL-3.0-or-later
#include "address_moves.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "triskin/session/controller.hpp"

namespace triskin::device {
namespace {

constexpr std::uint64_t kRestart_us = 20'000;  // Time in which a controller restarts under its new address.

constexpr int kAssignRounds = 5;  // Nobody confirms an assignment, and its frames or the claims after it may be lost.

}  // namespace

std::vector<wire::NodeClaim> assign_addresses(Bus& bus, std::map<wire::UniqueId, int> wanted) {
  std::vector<wire::NodeClaim> claims;
  for (int round = 0; round < kAssignRounds && !wanted.empty(); ++round) {
    for (const auto& [id, address] : wanted) bus.assign(id, static_cast<std::uint8_t>(address));
    bus.listen(bus.now_us() + kRestart_us);
    // A link of several wires learns here which one leads to which address.
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
                  bus.name(), to_text(id), address));
}

}  // namespace triskin::device
