// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <functional>
#include <string>
#include <vector>

namespace triskin::bridge {

/// How far a node of ROS 2 looks for others (docs.ros.org, "Improved Dynamic Discovery").
enum class DiscoveryRange {
  kUnset,      ///< No variable says it: DDS as it is configured.
  kLoopback,   ///< ROS_LOCALHOST_ONLY=1, up to Humble: the loopback interface alone.
  kLocalhost,  ///< This computer, and peers that are named.
  kSubnet,     ///< Whoever multicast reaches, and peers that are named.
  kOff         ///< Nobody, not even on this computer.
};

/// What the environment says about discovery.
struct RosDiscovery {
  DiscoveryRange range = DiscoveryRange::kUnset;
  std::vector<std::string> peers;  ///< Names or addresses of computers.
  std::string words;               ///< For the user, with the variable that says it; empty: nothing to say.
};

/// Reads ROS_LOCALHOST_ONLY, ROS_AUTOMATIC_DISCOVERY_RANGE and ROS_STATIC_PEERS (semicolons between them) as nodes of
/// ROS 2 do: ROS_LOCALHOST_ONLY=1 outweighs the other two, SYSTEM_DEFAULT leaves all to DDS, and OFF has no peers.
/// `variable` returns the value of an environment variable, nullptr where it is not set. Throws InputError that names
/// the variable, its value and what it may be.
[[nodiscard]] RosDiscovery ros_discovery(const std::function<const char*(const char*)>& variable);

/// The same as a configuration of Cyclone DDS (XML), which CYCLONEDDS_URI may stand behind to overrule it. `process`:
/// what no other process has, as its number. Empty: nothing to configure.
[[nodiscard]] std::string cyclone_configuration(const RosDiscovery& discovery, long process);

}  // namespace triskin::bridge
