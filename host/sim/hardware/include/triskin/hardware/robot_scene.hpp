// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "triskin/hardware/scene.hpp"

namespace triskin::hardware {

/// A part of a robot is a cover of its robot file.
struct RobotPart {
  std::string name;  ///< Names are unique on the robot.
  design::Design design;
};

/// A scene of a robot has a scene for each part. Seed, hardware, pressure and effects are the same for all parts;
/// contacts, faults and clocks belong to one of them. Places are in the mesh frame of their part.
struct RobotScene {
  std::filesystem::path file;      ///< The scene file.
  std::filesystem::path robot;     ///< The robot file, relative to the working directory.
  std::vector<std::string> names;  ///< Names are indexed by part.
  std::vector<Scene> parts;        ///< Their expectations are empty.
  /// All expectations in the order of the file. Expectation::part names the part, and modules are those of its design.
  std::vector<Expectation> expectations;
};

/// Returns true if the file is a scene that names a robot in place of a design. Throws InputError if it cannot be read
/// or is not JSON.
[[nodiscard]] bool is_robot_scene(const std::filesystem::path& path);

/// Reads a scene of a robot. `parts_of` gets the path of the robot file and returns its covers in their order. Throws
/// as read_scene does, also for a part that the robot lacks or that a contact, fault or module does not name, and as
/// `parts_of` does.
[[nodiscard]] RobotScene read_robot_scene(
    const std::filesystem::path& path,
    const std::function<std::vector<RobotPart>(const std::filesystem::path& robot)>& parts_of);

}  // namespace triskin::hardware
