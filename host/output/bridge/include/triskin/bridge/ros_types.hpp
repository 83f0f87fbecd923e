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
extern const RosType kRaw, kLayout, kContacts, kPoints, kDiagnostics, kTransforms, kWrench, kStop, kMarkers;
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

/// What contacts exert on a link, in its frame.
struct Wrench {
  std::array<double, 3> force_n{}, torque_nm{};  ///< about the origin of the frame
};
/// Sums the forces of contacts against their normals. `pose` is that of the cover's frame in the link's.
[[nodiscard]] Wrench wrench_of(std::span<const recording::Contact> contacts, double newton_per_count, const Pose& pose);
/// Encodes a geometry_msgs/msg/WrenchStamped. Throws nothing of its own.
[[nodiscard]] std::vector<std::uint8_t> encode_wrench(const Wrench& wrench, std::uint64_t stamp_ns,
                                                      std::string_view frame_id);

/// Encodes a visualization_msgs/msg/MarkerArray: the modules as triangles, coloured by the sum of their change, and an
/// arrow for each contact; of `arrows_before` arrows of the last message those that are too many are deleted.
[[nodiscard]] std::vector<std::uint8_t> encode_markers(const design::Design& design,
                                                       std::span<const recording::Contact> contacts,
                                                       std::size_t arrows_before, std::uint64_t stamp_ns,
                                                       std::string_view frame_id);

}  // namespace triskin::bridge
