// SPDX-License-Identifier: GPL-3.0-or-later
#include "triskin/bridge/ros_types.hpp"

#include <fmt/format.h>

#include "triskin/recording/cdr.hpp"
#include "triskin/recording/ros_text.hpp"

namespace triskin::bridge {
namespace {

using recording::CdrWriter;
using recording::MessageType;

const MessageType kDiagnosticsType{"diagnostic_msgs/msg/DiagnosticArray",
                                   "std_msgs/Header header\n"
                                   "diagnostic_msgs/DiagnosticStatus[] status\n" TRISKIN_ROS_HEADER TRISKIN_ROS_RULE
                                   "MSG: diagnostic_msgs/DiagnosticStatus\n"
                                   "byte OK=0\n"
                                   "byte WARN=1\n"
                                   "byte ERROR=2\n"
                                   "byte STALE=3\n"
                                   "byte level\n"
                                   "string name\n"
                                   "string message\n"
                                   "string hardware_id\n"
                                   "diagnostic_msgs/KeyValue[] values\n" TRISKIN_ROS_RULE
                                   "MSG: diagnostic_msgs/KeyValue\n"
                                   "string key\n"
                                   "string value\n"};

const MessageType kWrenchType{"geometry_msgs/msg/WrenchStamped",
                              "std_msgs/Header header\n"
                              "geometry_msgs/Wrench wrench\n" TRISKIN_ROS_HEADER TRISKIN_ROS_RULE
                              "MSG: geometry_msgs/Wrench\n"
                              "geometry_msgs/Vector3 force\n"
                              "geometry_msgs/Vector3 torque\n" TRISKIN_ROS_RULE
                              "MSG: geometry_msgs/Vector3\n"
                              "float64 x\n"
                              "float64 y\n"
                              "float64 z\n"};

const MessageType kBoolType{"std_msgs/msg/Bool", "bool data\n"};

const MessageType kMarkersType{"visualization_msgs/msg/MarkerArray",
                               "visualization_msgs/Marker[] markers\n" TRISKIN_ROS_RULE
                               "MSG: visualization_msgs/Marker\n"
                               "std_msgs/Header header\n"
                               "string ns\n"
                               "int32 id\n"
                               "int32 type\n"
                               "int32 action\n"
                               "geometry_msgs/Pose pose\n"
                               "geometry_msgs/Vector3 scale\n"
                               "std_msgs/ColorRGBA color\n"
                               "builtin_interfaces/Duration lifetime\n"
                               "bool frame_locked\n"
                               "geometry_msgs/Point[] points\n"
                               "std_msgs/ColorRGBA[] colors\n"
                               "string texture_resource\n"
                               "sensor_msgs/CompressedImage texture\n"
                               "visualization_msgs/UVCoordinate[] uv_coordinates\n"
                               "string text\n"
                               "string mesh_resource\n"
                               "visualization_msgs/MeshFile mesh_file\n"
                               "bool mesh_use_embedded_materials\n" TRISKIN_ROS_HEADER TRISKIN_ROS_RULE
                               "MSG: builtin_interfaces/Duration\n"
                               "int32 sec\n"
                               "uint32 nanosec\n" TRISKIN_ROS_RULE
                               "MSG: geometry_msgs/Point\n"
                               "float64 x\n"
                               "float64 y\n"
                               "float64 z\n" TRISKIN_ROS_RULE
                               "MSG: geometry_msgs/Pose\n"
                               "geometry_msgs/Point position\n"
                               "geometry_msgs/Quaternion orientation\n" TRISKIN_ROS_RULE
                               "MSG: geometry_msgs/Quaternion\n"
                               "float64 x\n"
                               "float64 y\n"
                               "float64 z\n"
                               "float64 w\n" TRISKIN_ROS_RULE
                               "MSG: geometry_msgs/Vector3\n"
                               "float64 x\n"
                               "float64 y\n"
                               "float64 z\n" TRISKIN_ROS_RULE
                               "MSG: sensor_msgs/CompressedImage\n"
                               "std_msgs/Header header\n"
                               "string format\n"
                               "uint8[] data\n" TRISKIN_ROS_RULE
                               "MSG: std_msgs/ColorRGBA\n"
                               "float32 r\n"
                               "float32 g\n"
                               "float32 b\n"
                               "float32 a\n" TRISKIN_ROS_RULE
                               "MSG: visualization_msgs/MeshFile\n"
                               "string filename\n"
                               "uint8[] data\n" TRISKIN_ROS_RULE
                               "MSG: visualization_msgs/UVCoordinate\n"
                               "float32 u\n"
                               "float32 v\n"};

std::vector<std::uint8_t> bytes_of(const CdrWriter& w) {
  return {w.message().begin(), w.message().end()};
}

}  // namespace

// The hashes are computed from the definitions; tests/output/bridge/type_hash.py checks them.
const RosType kRaw{recording::kRawFrameType, "RIHS01_73cb35a97e218354bc1b0cf26b0d649e96dc34049322e8af47a52a640139eaf5"};
const RosType kLayout{recording::kLayoutType,
                      "RIHS01_2ba07a59f18ea16c25f1aa6bcd8aca9896275796377c3fcbad20f5846c9e8aef"};
const RosType kContacts{recording::kContactsType,
                        "RIHS01_67b6910a494dfaa0a3dfab5eff2f997e49943635ce28ff9077c30982634b878c"};
const RosType kPoints{recording::kPointCloudType,
                      "RIHS01_9198cabf7da3796ae6fe19c4cb3bdd3525492988c70522628af5daa124bae2b5"};
const RosType kDiagnostics{kDiagnosticsType, "RIHS01_5a8a36efb05fb25070fa0fb3810290c0e6cd4862b54a8fb975a1ee8dc55a333e"};
const RosType kTransforms{recording::kTransformsType,
                          "RIHS01_e369d0f05a23ae52508854b66f6aa0437f3449d652e8cbf22d5abe85d020f087"};
const RosType kWrench{kWrenchType, "RIHS01_8dc3deaf06b2ab281f9f9a742a8961c328ca7cec16e3fd6586d3a5c83fa78f77"};
const RosType kStop{kBoolType, "RIHS01_feb91e995ff9ebd09c0cb3d2aed18b11077585839fb5db80193b62d74528f6c9"};
const RosType kMarkers{kMarkersType, "RIHS01_86cb8800b6fb05b5eff1abd7a56f62a5641d3ae9a1c29e78e67e704f1d067dcf"};

std::span<const RosType* const> all_types() {
  static constexpr std::array<const RosType*, 9> kAll{&kRaw,        &kLayout, &kContacts, &kPoints, &kDiagnostics,
                                                      &kTransforms, &kWrench, &kStop,     &kMarkers};
  return kAll;
}

std::string dds_service_name(std::string_view ros_name) {
  const std::size_t first = ros_name.find('/'), last = ros_name.rfind('/');
  return fmt::format("{}::{}::dds_::{}", ros_name.substr(0, first), ros_name.substr(first + 1, last - first - 1),
                     ros_name.substr(last + 1));
}

std::string dds_name(std::string_view ros_name) {
  return dds_service_name(ros_name) + "_";
}

std::vector<std::uint8_t> encode_diagnostics(std::span<const Diagnosis> parts, std::uint64_t stamp_ns) {
  CdrWriter w;
  recording::put_header(w, stamp_ns, "");
  w.count(parts.size());
  for (const Diagnosis& d : parts) {
    w.u8(static_cast<std::uint8_t>(d.level));
    w.text(d.name);
    w.text(d.message);
    w.text(d.hardware_id);
    w.count(d.values.size());
    for (const auto& [key, value] : d.values) {
      w.text(key);
      w.text(value);
    }
  }
  return bytes_of(w);
}

}  // namespace triskin::bridge
