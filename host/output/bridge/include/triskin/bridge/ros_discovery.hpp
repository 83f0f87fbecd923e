// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <functional>
#include <string>
#include <vector>

namespace triskin::bridge {

/// These ranges limit where a ROS 2 node looks for other nodes (docs.ros.org, "Improved Dynamic Discovery").
enum class DiscoveryRange {
  kUnset,      ///< No variable sets a range, so the configuration of DDS applies.
  kLoopback,   ///< ROS_LOCALHOST_ONLY=1 (up to Humble) limits DDS to the loopback interface.
  kLocalhost,  ///< The node finds nodes on this computer and the named peers.
  kSubnet,     ///< The node finds all nodes that multicast reaches and the named peers.
  kOff         ///< The node finds no other node, not even on this computer.
};

/// The environment variables of ROS 2 give these settings.
struct RosDiscovery {
  DiscoveryRange range = DiscoveryRange::kUnset;
  std::vector<std::string> peers;  ///< Each peer is the name or address of a computer.
  std::string words;  ///< The sentence tells the user which variable set the range; it is empty if none did.
};

/// Reads ROS_LOCALHOST_ONLY, ROS_AUTOMATIC_DISCOVERY_RANGE and ROS_STATIC_PEERS (separated by semicolons) as ROS 2
/// nodes do: ROS_LOCALHOST_ONLY=1 overrides the other two, SYSTEM_DEFAULT leaves everything to DDS, and OFF ignores
/// peers. `variable` returns the value of an environment variable, or nullptr if it is not set. Throws InputError
/// naming the variable, its value and the allowed values.
[[nodiscard]] RosDiscovery ros_discovery(const std::function<const char*(const char*)>& variable);

}  // namespace triskin::bridge
