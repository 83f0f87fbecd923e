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

// The names and addresses are written into XML, so characters outside of these sets are refused.
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

std::string peer_list(const RosDiscovery& d, bool with_localhost) {
  std::string list = with_localhost ? "<Peer Address=\"localhost\"/>" : "";
  for (const std::string& peer : d.peers) list += fmt::format("<Peer Address=\"{}\"/>", peer);
  return list.empty() ? "" : "<Peers>" + list + "</Peers>";
}

// A participant with an index uses a predictable port, so peers without multicast can reach it.
constexpr const char* kKnownPorts =
    "<ParticipantIndex>auto</ParticipantIndex><MaxAutoParticipantIndex>32</MaxAutoParticipantIndex>";
constexpr const char* kNoMulticast = "<General><AllowMulticast>false</AllowMulticast></General>";

std::string domain_settings(const RosDiscovery& d, long process) {
  switch (d.range) {
    case DiscoveryRange::kLoopback:
      return fmt::format(
          "<General><Interfaces><NetworkInterface address=\"127.0.0.1\"/></Interfaces></General>"
          "<Discovery>{}{}</Discovery>",
          kKnownPorts, peer_list(d, true));
    case DiscoveryRange::kLocalhost:
      return fmt::format("{}<Discovery>{}{}</Discovery>", kNoMulticast, kKnownPorts, peer_list(d, true));
    case DiscoveryRange::kOff:
      return fmt::format(
          "{}<Discovery><ParticipantIndex>none</ParticipantIndex><Tag>ros_discovery_off_{}</Tag></Discovery>",
          kNoMulticast, process);
    case DiscoveryRange::kSubnet:
    case DiscoveryRange::kUnset:
      break;
  }
  return d.peers.empty() ? "" : fmt::format("<Discovery>{}{}</Discovery>", kKnownPorts, peer_list(d, false));
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

std::string cyclone_configuration(const RosDiscovery& discovery, long process) {
  const std::string settings = domain_settings(discovery, process);
  return settings.empty() ? "" : "<CycloneDDS><Domain>" + settings + "</Domain></CycloneDDS>";
}

}  // namespace triskin::bridge
