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

/// The bridge publishes these types. Most come from host/device/recording; here are two types of ROS that a recording
/// does not use, and the type hashes of ROS.
namespace triskin::bridge {

/// ROS compares the hash of a message type (REP-2016, version 1) before it matches a reader and a writer.
struct RosType {
  const recording::MessageType& message;
  std::string_view hash;  ///< The hash is "RIHS01_" followed by 64 hexadecimal digits.
};
extern const RosType kRaw, kLayout, kContacts, kPoints, kDiagnostics, kTransforms;
/// Returns all types that the bridge publishes.
[[nodiscard]] std::span<const RosType* const> all_types();
/// Converts "sensor_msgs/msg/PointCloud2" to "sensor_msgs::msg::dds_::PointCloud2_".
[[nodiscard]] std::string dds_name(std::string_view ros_name);
/// Converts "triskin_msgs/srv/Tare" to "triskin_msgs::srv::dds_::Tare", to which "_Request_" or "_Response_" is
/// appended.
[[nodiscard]] std::string dds_service_name(std::string_view ros_name);

/// Each part of the skin has a state, for diagnostic_msgs/msg/DiagnosticStatus.
struct Diagnosis {
  enum class Level : std::uint8_t { kOk = 0, kWarn = 1, kError = 2, kStale = 3 };
  Level level = Level::kOk;
  std::string name, message, hardware_id;
  std::vector<std::pair<std::string, std::string>> values;
};
/// Encodes a diagnostic_msgs/msg/DiagnosticArray. `stamp_ns` counts from 1970. Throws nothing of its own.
[[nodiscard]] std::vector<std::uint8_t> encode_diagnostics(std::span<const Diagnosis> parts, std::uint64_t stamp_ns);

using recording::encode_transform;
using recording::Pose;

}  // namespace triskin::bridge
