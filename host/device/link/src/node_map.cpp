// SPDX-License-Identifier: GPL-3.0-or-later
#include "triskin/link/node_map.hpp"

#include "triskin/wire/node_claim.hpp"
#include "triskin/wire/uds.hpp"

namespace triskin::link {
namespace {

constexpr std::uint32_t kPhysicalMask = 0x1FFF0000U;
constexpr std::size_t kAddressInClaim = 6;  // The address is at this position in the second frame.

}  // namespace

void NodeMap::heard(const wire::CanFrame& f, int wire) {
  std::uint8_t node = 0;
  if (wire::is_claim(f) && f.size == 8 && f.data[0] == 1) {
    node = f.data[kAddressInClaim];
  } else if (f.extended && (f.id & kPhysicalMask) == wire::kPhysicalBase &&
             (f.id >> 8 & 0xFF) == wire::kTesterAddress) {
    node = static_cast<std::uint8_t>(f.id);
  } else {
    return;
  }
  const auto [at, fresh] = wires_.try_emplace(node, wire);
  if (!fresh && at->second != wire) at->second = kSeveral;
}

void NodeMap::sent(const wire::CanFrame& f) {
  if (f.extended && (f.id == wire::kWhoIsThereId || f.id == wire::kAssignId)) wires_.clear();
}

std::optional<int> NodeMap::wire_of(std::uint8_t node) const {
  const auto at = wires_.find(node);
  return at == wires_.end() || at->second == kSeveral ? std::nullopt : std::optional(at->second);
}

std::optional<std::uint8_t> NodeMap::target_of(const wire::CanFrame& f) {
  const bool request =
      f.extended && (f.id & kPhysicalMask) == wire::kPhysicalBase && (f.id & 0xFF) == wire::kTesterAddress;
  return request ? std::optional(static_cast<std::uint8_t>(f.id >> 8)) : std::nullopt;
}

}  // namespace triskin::link
