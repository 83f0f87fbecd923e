// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <Eigen/Geometry>
#include <array>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "triskin/base/format_index.hpp"
#include "triskin/layout/index.hpp"
#include "triskin/layout/module.hpp"
#include "triskin/wire/bus_load.hpp"

namespace triskin::robot {

/// A bus of the robot is a CAN bus, or several USB devices that are read as one bus.
struct BusEntry {
  std::string name;
  /// The text has the syntax of --link: can:IFACE, usb:SERIAL,…, sim:HOST:PORT, sim, sim-usb.
  std::string link = "sim";
  wire::BitRates rates = wire::kControllerRates;  ///< The rates of a CAN bus are in bit/s.
  int first_node = layout::kFirstNode;            ///< The node addresses of the bus begin here, 1 to 126.
  int last_node = layout::kLastNode;
  double cable_mm = 0.0;  ///< The length is from end to end; 0 means that it is not given.
};

struct ControllerEntry {
  layout::PatchIndex patch;  ///< The patch belongs to the cover's design.
  layout::NodeAddress node;
  /// The serial number is the unique id in 24 upper-case hexadecimal digits, or empty while unknown.
  std::string serial;
  std::string bus;  ///< An empty text means that the controller is on the bus of its cover.
  /// The length is from the bus, or the USB hub, to the controller; 0 means that it is not given.
  double cable_mm = 0.0;
};

/// Records how the pose of a cover was measured (docs/robot.md).
struct Measured {
  int points = 0;
  double rms_mm = 0.0;
};

/// A cover of the robot is a design with its pose and its controllers.
struct CoverEntry {
  std::string name;
  std::string design;           ///< The path is relative to the robot file.
  std::uint64_t design_id = 0;  ///< The design had this id when it was added.
  std::string bus;              ///< The controllers are on this bus unless they name another.
  std::string frame;            ///< The cover is fixed to this link of the robot; an empty text means the robot's base.
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();  ///< The pose is that of the mesh frame in the link, in mm.
  bool has_pose = false;  ///< False means that the pose is not known, and `pose` is only a stand-in.
  /// If the file gives the pose in this form, these are x, y, z in mm, then roll, pitch, yaw in rad (fixed axes, as in
  /// URDF).
  std::optional<std::array<double, 6>> xyz_rpy;
  std::optional<Measured> measured;
  double rate_hz = 0.0;  ///< Each module should give this many samples per second; 0 asks for as many as fit.
  std::vector<ControllerEntry> controllers;
};

/// A robot file (docs/robot.md) lists the covers of the robot, and what is connected to each bus.
struct Robot {
  static constexpr int kVersion = 1;
  std::string name;
  std::string urdf;  ///< The robot's links are in this file, relative to the robot file; it may be empty.
  std::vector<BusEntry> buses;
  std::vector<CoverEntry> covers;
};

/// Returns true if the file is JSON in the format of robot files, of any version. Throws InputError when it cannot be
/// read.
[[nodiscard]] bool is_robot_file(const std::filesystem::path& path);
/// Reads a robot file and checks its form: keys, types, ranges, and that poses are rigid motions. Throws InputError
/// naming file and key, and for another version the remedy. check() compares the parts with each other.
[[nodiscard]] Robot read_robot(const std::filesystem::path& path);
/// Does the same as read_robot, but from text; throws InputError naming it `file`.
[[nodiscard]] Robot parse_robot(const std::string& text, const std::string& file);
/// Formats a robot file, with one line for each bus and controller.
[[nodiscard]] std::string robot_text(const Robot& robot);

/// Parses a pose as in the file, {"matrix":[[…]]} or {"xyz_mm":[…],"rpy_rad":[…]}. Throws InputError naming
/// `file`.
[[nodiscard]] Eigen::Isometry3d parse_pose(const std::string& text, const std::string& file);
/// Parses PATCH=SERIAL, where SERIAL is the unique id with 24 hexadecimal digits, as triskin discover shows it. Throws
/// InputError.
[[nodiscard]] std::pair<layout::PatchIndex, std::string> parse_serial(const std::string& text);
/// Makes the pose of x, y, z (mm) and roll, pitch, yaw (rad) about fixed axes, as in URDF and SDF.
[[nodiscard]] Eigen::Isometry3d pose_of(const std::array<double, 6>& xyz_rpy);
/// Returns the index of a controller's bus in `robot.buses`; −1 if none has that name.
[[nodiscard]] int bus_of(const Robot& robot, const CoverEntry& cover, const ControllerEntry& controller);
/// Returns true for a valid name of a robot, bus or cover: UTF-8 of 1 … 64 bytes, letters of any script, digits, "_",
/// "-"; a letter first. Where a format takes ASCII alone, ascii_name() spells it.
[[nodiscard]] bool is_name(const std::string& text);
/// Returns true for a frame that tf2 takes: a name without a leading slash and without blanks.
[[nodiscard]] bool is_frame_name(const std::string& text);
/// Throws InputError, which begins with `option`, unless the place of a cover in its link is finite and at most 10 m
/// along each axis, as far as a robot reaches. `question` asks about the unit of the numbers.
void require_reach(const Eigen::Vector3d& place_mm, const std::string& option, const std::string& question);

}  // namespace triskin::robot
