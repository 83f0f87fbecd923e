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

/// An assembly has a robot file together with the files that it names.
struct Assembly {
  std::filesystem::path file;
  Robot robot;
  std::vector<design::Design> designs;
  std::optional<Frames> frames;  ///< The frames are empty when the robot file names no URDF.
};
/// Reads a robot file, its designs and its URDF, without comparing them. Throws InputError naming the cover and the
/// file that cannot be read or was changed by hand.
[[nodiscard]] Assembly read_assembly(const std::filesystem::path& path);

/// Assembles a robot that is not written yet; its paths are relative to `file`.
[[nodiscard]] Assembly assemble(const Robot& robot, const std::filesystem::path& file);

/// A problem is a mistake in a robot file.
struct Problem {
  std::string place;  ///< The text names a bus or cover and the affected part of it.
  std::string text;
  std::string remedy;  ///< The text says what to do.
};
/// Returns all mistakes of a robot, in the order of the file; an empty list means that it may be deployed.
/// docs/robot.md lists the rules. Cost: linear.
[[nodiscard]] std::vector<Problem> check(const Assembly& assembly);

/// The samples of all covers together load a bus.
struct BusLoad {
  int controllers = 0;
  int modules = 0;
  /// The load if every sample is streamed is a fraction of the capacity of the busiest wire of this bus.
  double full = 0.0;
  int every = 1;         ///< Each n-th sample fits the bus, with the smallest possible n.
  double rate_hz = 0.0;  ///< Each module then gives this many samples per second.
};
/// Computes the loads, indexed by bus. Cost: linear.
[[nodiscard]] std::vector<BusLoad> bus_loads(const Assembly& assembly);

}  // namespace triskin::robot
