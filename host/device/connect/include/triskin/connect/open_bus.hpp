// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>

#include "triskin/connect/open_link.hpp"
#include "triskin/hardware/joint_scene.hpp"
#include "triskin/hardware/robot_scene.hpp"
#include "triskin/robot/site.hpp"

namespace triskin::connect {

/// Opens the link of bus `bus` (0-based) of a site. For a design file it does the same as open_link. For a robot file
/// it opens the link that the file names, or `options.link` if it is `chosen`: `sim` simulates each bus in this
/// process, as CAN or as USB hub according to the file; `sim:HOST:PORT` is bus 0 of `triskin simulate ROBOT --listen
/// HOST:PORT`, and further buses use the following ports. A scene simulates each bus in this process. Throws as
/// open_link does, and InputError for any other chosen link of a robot with several buses, or a scene of another robot.
[[nodiscard]] std::unique_ptr<link::Link> open_bus(const robot::Site& site, std::size_t bus,
                                                   const LinkOptions& options);

/// Reads a scene of a robot and the robot file that it names. Throws as hardware::read_robot_scene and robot::read_site
/// do.
[[nodiscard]] hardware::RobotScene read_robot_scene(const std::filesystem::path& path);

/// Makes the simulation of a robot's bus: its covers with what `scene` has for them, or with nobody touching them if it
/// is null. `board_seed` as LinkOptions::board_seed. Throws InputError if a cover of the bus is not in the scene or has
/// another design there, and as hardware::join_covers.
[[nodiscard]] hardware::JointScene scene_of(const robot::BusConfig& bus, const hardware::RobotScene* scene,
                                            bool switched, std::optional<std::uint64_t> board_seed);
/// Returns the folder that stores the flash of its simulated controllers, by unique id.
[[nodiscard]] std::filesystem::path state_folder_of(const robot::Site& site, const robot::BusConfig& bus);

}  // namespace triskin::connect
