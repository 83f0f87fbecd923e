// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstdint>
#include <map>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

namespace triskin::bridge {

/// The types of parameters of ROS 2 that this program has.
using ParameterValue = std::variant<bool, std::int64_t, double, std::string>;

/// Under which name ROS 2 shows this program, and how it renames what it publishes and serves.
struct RosNode {
  std::string space = "/";                                  ///< begins with "/"
  std::string name = "triskin_bridge";                      ///< letters, digits and _
  std::vector<std::pair<std::string, std::string>> remaps;  ///< "from:=to"; the first that fits is taken
  std::map<std::string, ParameterValue> parameters;         ///< given by -p
  /// ROS 2 up to Humble identifies endpoints by 24 bytes, later by 16, in a message of the same name and type.
  bool gid_has_24_bytes = false;

  /// Returns the full name of a topic or service as ROS 2 makes it: "a/b" is in the namespace, "/a/b" is absolute,
  /// "~/a" belongs to the node; then the remaps.
  [[nodiscard]] std::string resolve(std::string_view relative) const;
};

/// Reads what follows --ros-args: -r and --remap RULE (also __node:=, __ns:=), -p and --param NAME:=VALUE; --log-level
/// and --enclave are read past. `distribution` is the value of ROS_DISTRO, empty if not set. Throws InputError naming
/// the argument.
[[nodiscard]] RosNode ros_node(std::span<const std::string> arguments, std::string_view distribution);

}  // namespace triskin::bridge
