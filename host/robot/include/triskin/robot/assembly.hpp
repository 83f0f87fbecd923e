// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "triskin/design/design.hpp"
#include "triskin/robot/frames.hpp"
#include "triskin/robot/robot.hpp"

namespace triskin::robot {

/// A robot file with the files that it names.
struct Assembly {
  std::filesystem::path file;
  Robot robot;
  std::vector<design::Design> designs;  ///< They are indexed by cover.
  std::optional<Frames> frames;         ///< It is empty when the robot file names no URDF.
};
/// Reads a robot file, its designs and its URDF; nothing is held against each other yet. Throws InputError naming the
/// cover and the file that cannot be read or was changed by hand.
[[nodiscard]] Assembly read_assembly(const std::filesystem::path& path);

/// The same for a robot that is not written yet; `file` says where its paths begin.
[[nodiscard]] Assembly assemble(const Robot& robot, const std::filesystem::path& file);

/// Something in a robot file that cannot be.
struct Problem {
  std::string place;   ///< It names a bus or cover, and which part of it.
  std::string text;    ///< It says what is wrong.
  std::string remedy;  ///< It says what to do.
};
/// Everything that is wrong with a robot, in the order of the file; empty: it may be deployed. docs/robot_file.md lists
/// the rules. Cost: linear.
[[nodiscard]] std::vector<Problem> check(const Assembly& assembly);

/// What the samples of all covers take of a bus.
struct BusLoad {
  int controllers = 0;
  int modules = 0;
  double full = 0.0;     ///< It is the load if every sample is streamed, 1 being all of the fullest wire of this bus.
  int every = 1;         ///< It is the smallest n whose n-th samples fit.
  double rate_hz = 0.0;  ///< Each module then gives so many samples a second.
};
/// Indexed by bus. Cost: linear.
[[nodiscard]] std::vector<BusLoad> bus_loads(const Assembly& assembly);

}  // namespace triskin::robot
