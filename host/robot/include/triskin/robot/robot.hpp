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

#include "triskin/layout/module.hpp"
#include "triskin/wire/bus_load.hpp"

namespace triskin::robot {

/// A bus of the robot: a CAN bus, or USB devices that are read as one bus.
struct BusEntry {
  std::string name;
  std::string link = "sim";  ///< It has the syntax of --link: can:IFACE, usb:SERIAL,…, sim:HOST:PORT, sim, sim-usb.
  wire::BitRates rates = wire::kControllerRates;  ///< They are the bit rates of a CAN bus in bit/s.
  int first_node = layout::kFirstNode;            ///< Its node addresses begin here; they range from 1 to 126.
  int last_node = layout::kLastNode;
  double cable_mm = 0.0;  ///< It is the length from end to end; 0 means that it is not given.
};

/// The controller of one patch.
struct ControllerEntry {
  int patch = 0;       ///< It is a patch of the cover's design, counted from 0.
  int node = 0;        ///< It is the node address on its bus.
  std::string serial;  ///< It is the unique id in 24 upper-case hexadecimal digits, and empty while unknown.
  std::string bus;     ///< If it is empty, the controller is on the bus of its cover.
  /// It is the length from the bus, or the USB hub, to the controller; 0 means that it is not given.
  double cable_mm = 0.0;
};

/// How the pose of a cover was measured (docs/robot_file.md).
struct Measured {
  int points = 0;
  double rms_mm = 0.0;
};

/// A cover: one design at one place of the robot.
struct CoverEntry {
  std::string name;
  std::string design;           ///< It is a file, relative to the robot file.
  std::uint64_t design_id = 0;  ///< The design had this id when it was added.
  std::string bus;              ///< Its controllers are on this bus unless they name another.
  std::string frame;            ///< It is fixed to this link of the robot; if empty, to the robot's base.
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();  ///< It is the pose of the mesh frame in that link, in mm.
  bool has_pose = false;  ///< false: nobody has said where it lies, and `pose` is only a stand-in
  /// x, y, z in mm, then roll, pitch, yaw in rad (fixed axes, as URDF has them), where the file gives the pose so.
  std::optional<std::array<double, 6>> xyz_rpy;
  std::optional<Measured> measured;
  double rate_hz = 0.0;  ///< So many samples a second are wanted of each module; 0 asks for as many as fit.
  std::vector<ControllerEntry> controllers;
};

/// A robot file (docs/robot_file.md): which covers the robot wears, and what hangs on which bus.
struct Robot {
  static constexpr int kVersion = 1;
  std::string name;
  std::string urdf;  ///< The robot's links are in this file, relative to the robot file; it may be empty.
  std::vector<BusEntry> buses;
  std::vector<CoverEntry> covers;
};

/// True: the file is JSON whose format is that of robot files, of any version. Throws InputError when it cannot be
/// read.
[[nodiscard]] bool is_robot_file(const std::filesystem::path& path);
/// Reads a robot file and checks its form: keys, types, ranges, that a pose turns and moves only. Throws InputError
/// naming file and key, for another version with the remedy. What the parts say of each other is checked by check().
[[nodiscard]] Robot read_robot(const std::filesystem::path& path);
/// read_robot for the text of a file; throws InputError naming it `file`.
[[nodiscard]] Robot parse_robot(const std::string& text, const std::string& file);
/// The text of the file: one line a bus and a controller.
[[nodiscard]] std::string robot_text(const Robot& robot);

/// A pose as the file has it, {"matrix":[[…]]} or {"xyz_mm":[…],"rpy_rad":[…]}. Throws InputError naming `file`.
[[nodiscard]] Eigen::Isometry3d parse_pose(const std::string& text, const std::string& file);
/// PATCH=SERIAL, the unique id with 24 hexadecimal digits, as triskin discover shows it. Throws InputError.
[[nodiscard]] std::pair<int, std::string> parse_serial(const std::string& text);
/// Pose of x, y, z (mm) and roll, pitch, yaw (rad) about fixed axes, as URDF and SDF have them.
[[nodiscard]] Eigen::Isometry3d pose_of(const std::array<double, 6>& xyz_rpy);
/// Index of the bus of a controller in `robot.buses`; −1: there is none of that name.
[[nodiscard]] int bus_of(const Robot& robot, const CoverEntry& cover, const ControllerEntry& controller);
/// True for a name of a robot, bus or cover: 1 … 64 letters, digits, "_", "-"; a letter first.
[[nodiscard]] bool is_name(const std::string& text);

}  // namespace triskin::robot
