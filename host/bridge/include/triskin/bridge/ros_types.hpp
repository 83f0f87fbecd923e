// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "triskin/recording/messages.hpp"

/// Types that the bridge publishes. Those of host/recording are used as they are; here are the two of ROS that a
/// recording has no use for, and what ROS calls the hash of a type.
namespace triskin::bridge {

/// A message type with its hash (REP-2016, version 1), which ROS compares before a reader and a writer match.
struct RosType {
  const recording::MessageType& message;
  std::string_view hash;  ///< It is "RIHS01_" and 64 hexadecimal digits.
};
extern const RosType kRaw, kLayout, kContacts, kPoints, kDiagnostics, kTransforms;
/// All of them.
[[nodiscard]] std::span<const RosType* const> all_types();
/// "sensor_msgs::msg::dds_::PointCloud2_" of "sensor_msgs/msg/PointCloud2".
[[nodiscard]] std::string dds_name(std::string_view ros_name);
/// "triskin_msgs::srv::dds_::Tare" of "triskin_msgs/srv/Tare"; behind it stands "_Request_" or "_Response_".
[[nodiscard]] std::string dds_service_name(std::string_view ros_name);

/// State of a part of the skin, of diagnostic_msgs/msg/DiagnosticStatus.
struct Diagnosis {
  enum class Level : std::uint8_t { kOk = 0, kWarn = 1, kError = 2, kStale = 3 };
  Level level = Level::kOk;
  std::string name, message, hardware_id;
  std::vector<std::pair<std::string, std::string>> values;
};
/// diagnostic_msgs/msg/DiagnosticArray. `stamp_ns`: since 1970. Throws nothing of its own.
[[nodiscard]] std::vector<std::uint8_t> encode_diagnostics(std::span<const Diagnosis> parts, std::uint64_t stamp_ns);

using recording::encode_transform;
using recording::Pose;

}  // namespace triskin::bridge
