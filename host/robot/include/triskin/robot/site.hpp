// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <Eigen/Geometry>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "triskin/deploy/flash.hpp"
#include "triskin/design/design.hpp"
#include "triskin/design/side_by_side.hpp"
#include "triskin/robot/assembly.hpp"
#include "triskin/session/stream_options.hpp"

namespace triskin::robot {

/// What of a cover hangs on one bus.
struct CoverConfig {
  std::string name;  ///< It is the name of the cover on the robot, and empty for a design file.
  std::filesystem::path design_file;
  design::Design design;             ///< It has the node addresses of this bus and the cover's name.
  std::vector<std::string> serials;  ///< They are indexed by patch and empty while unknown.
  int cover = 0;                     ///< It is the index in the robot file.
  int first_module = 0;              ///< number of its module 0 on a simulated bus (device::CoverTouchActuator)
  bool chosen = true;                ///< If false, choose() left it out, and it keeps its addresses.
};

/// One bus and what hangs on it.
struct BusConfig {
  int number = 0;    ///< It counts from 0 among the buses of the robot that carry a cover.
  std::string name;  ///< It is empty for a design file.
  std::string link;  ///< It has the syntax of --link and is empty for a design file.
  wire::BitRates rates;
  int every = 0;  ///< Each n-th sample gives what the covers want; 0 takes as many as fit.
  std::vector<CoverConfig> covers;
};

/// What device commands work on: the buses of a robot file, or the one bus of a design file. This is the only place
/// that knows which of the two was given.
struct Site {
  std::filesystem::path file;
  std::string name;
  bool is_robot = false;
  std::vector<BusConfig> buses;  ///< They are the buses that carry at least one cover.
};
/// Reads a robot file or a design file that is to be deployed. Throws InputError as read_assembly and
/// read_intact_design do, and listing the problems of a robot that check() finds.
[[nodiscard]] Site read_site(const std::filesystem::path& path);
/// The same of a robot that was read. Throws InputError listing its problems, or where it has no covers.
[[nodiscard]] Site site_of(const Assembly& assembly);

/// Leaves out all covers but `name`, and the buses on which it has nothing; empty: nothing is left out. Throws
/// InputError naming the covers that there are.
void choose(Site& site, const std::string& name);

/// `options` for one cover of a bus: its serial numbers as assignments, the other covers as neighbours. Throws
/// std::out_of_range where serials or addresses do not match the patches, which read_site excludes; as those below.
[[nodiscard]] device::FlashOptions flash_options(const BusConfig& bus, const CoverConfig& cover,
                                                 device::FlashOptions options);

/// Controllers of the bus that `streamed` leaves out: they stream as well (device::StreamOptions::neighbours).
/// Throws as flash_options.
[[nodiscard]] std::vector<device::StreamDemand> other_demands(const BusConfig& bus,
                                                              std::span<const design::Design* const> streamed);

/// `options` for a stream of `streamed`: the other covers as neighbours, and the rate that the robot file wants where
/// `options` leaves it open. Throws as flash_options.
[[nodiscard]] device::StreamOptions stream_options(const BusConfig& bus,
                                                   std::span<const design::Design* const> streamed,
                                                   device::StreamOptions options);

/// All covers of a robot in the frame of its base (joints at 0), for pictures and exports; cover c of the robot file is
/// element c of the offsets. Throws as design::side_by_side does.
[[nodiscard]] design::SideBySide in_base(const Assembly& assembly);

/// What pictures and exports show of a file: a design as it is, the covers of a robot as in_base() joins them. Throws
/// InputError as design::read_design and read_assembly do.
[[nodiscard]] design::Design read_shown(const std::filesystem::path& path);

}  // namespace triskin::robot
