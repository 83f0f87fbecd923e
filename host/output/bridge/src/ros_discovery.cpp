// SPDX-License-Identifier: GPL-3.0-or-later
#include "triskin/bridge/ros_discovery.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <string_view>

#include "triskin/base/error.hpp"

namespace triskin::bridge {
namespace {

constexpr const char* kLocalhostOnly = "ROS_LOCALHOST_ONLY";
constexpr const char* kRange = "ROS_AUTOMATIC_DISCOVERY_RANGE";
constexpr const char* kPeers = "ROS_STATIC_PEERS";

bool localhost_only(std::string_view value) {
  if (value.empty() || value == "0") return false;
  if (value == "1") return true;
  throw InputError(fmt::format("{} is {}, not 0 or 1", kLocalhostOnly, value));
}

DiscoveryRange range_of(std::string_view value) {
  if (value.empty() || value == "SYSTEM_DEFAULT") return DiscoveryRange::kUnset;
  if (value == "SUBNET") return DiscoveryRange::kSubnet;
  if (value == "LOCALHOST") return DiscoveryRange::kLocalhost;
  if (value == "OFF") return DiscoveryRange::kOff;
  throw InputError(fmt::format("{} is {}, not SUBNET, LOCALHOST, OFF or SYSTEM_DEFAULT", kRange, value));
}

std::string_view trimmed(std::string_view text) {
  const std::size_t first = text.find_first_not_of(' ');
  return first == std::string_view::npos ? std::string_view()
                                         : text.substr(first, text.find_last_not_of(' ') + 1 - first);
}

std::vector<std::string> peers_of(std::string_view list) {
  constexpr std::string_view kAllowed = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789.-_:[]%";
  std::vector<std::string> peers;
  while (!list.empty()) {
    const std::string_view peer = trimmed(list.substr(0, list.find(';')));
    list.remove_prefix(
        std::min(list.size(), list.find(';') == std::string_view::npos ? list.size() : list.find(';') + 1));
    if (peer.empty()) continue;
    if (peer.find_first_not_of(kAllowed) != std::string_view::npos)
      throw InputError(fmt::format("{}: \"{}\" is no name or address of a computer; semicolons stand between several",
                                   kPeers, peer));
    peers.emplace_back(peer);
  }
  return peers;
}

std::string words_of(const RosDiscovery& d) {
  const std::string peers = d.peers.empty() ? "" : fmt::format(" and {} ({})", fmt::join(d.peers, ", "), kPeers);
  switch (d.range) {
    case DiscoveryRange::kLoopback:
      return fmt::format("on this computer alone ({}=1)", kLocalhostOnly);
    case DiscoveryRange::kLocalhost:
      return fmt::format("on this computer{} ({}=LOCALHOST)", peers.empty() ? " alone" : peers, kRange);
    case DiscoveryRange::kOff:
      return fmt::format("and nobody can find it ({}=OFF)", kRange);
    case DiscoveryRange::kSubnet:
    case DiscoveryRange::kUnset:
      break;
  }
  return peers.empty() ? "" : "on this network" + peers;
}

}  // namespace

RosDiscovery ros_discovery(const std::function<const char*(const char*)>& variable) {
  const auto value = [&](const char* name) {
    const char* text = variable(name);
    return std::string_view(text == nullptr ? "" : text);
  };
  RosDiscovery discovery;
  if (localhost_only(value(kLocalhostOnly))) {
    discovery.range = DiscoveryRange::kLoopback;
  } else {
    discovery.range = range_of(value(kRange));
    const bool is_left_to_dds = value(kRange) == "SYSTEM_DEFAULT";
    if (discovery.range != DiscoveryRange::kOff && !is_left_to_dds) discovery.peers = peers_of(value(kPeers));
  }
  discovery.words = words_of(discovery);
  return discovery;
}

}  // namespace triskin::bridge
