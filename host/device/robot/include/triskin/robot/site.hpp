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

/// Only the part of a cover that is connected to one bus is described here.
struct CoverConfig {
  std::string name;  ///< The name is that of the cover on the robot, or empty for a design file.
  std::filesystem::path design_file;
  design::Design design;             ///< The design has the node addresses of this bus and the cover's name.
  std::vector<std::string> serials;  ///< Serial numbers are indexed by patch and empty while unknown.
  int cover = 0;                     ///< The number is an index in the robot file.
  int first_module = 0;  ///< On a simulated bus, module 0 of the cover has this number (link::CoverTouchActuator).
  bool chosen = true;    ///< False means that choose() left the cover out; it keeps its addresses.
};

/// Several covers can be on one bus.
struct BusConfig {
  int number = 0;    ///< Only buses of the robot that have a cover are numbered, from 0.
  std::string name;  ///< A design file has no name for its bus.
  std::string link;  ///< The text has the syntax of --link; it is empty for a design file.
  wire::BitRates rates;
  int every = 0;  ///< With each n-th sample the covers get the rate that they want; 0 takes as many as fit.
  std::vector<CoverConfig> covers;
};

/// Device commands work on the buses of a robot file, or on the one bus of a design file. Only this file distinguishes
/// the two.
struct Site {
  std::filesystem::path file;
  std::string name;
  bool is_robot = false;
  std::vector<BusConfig> buses;  ///< Only buses with at least one cover are listed.
};
/// Reads a robot file or a design file for deployment. Throws InputError as read_assembly and read_intact_design do,
/// and listing the mistakes of a robot that check() finds.
[[nodiscard]] Site read_site(const std::filesystem::path& path);
/// Makes a site from a robot in memory. Throws InputError listing its mistakes, or if it has no covers.
[[nodiscard]] Site site_of(const Assembly& assembly);

/// Leaves out all covers except `name`, and the buses without a part of it; an empty name leaves nothing out. Throws
/// InputError naming the existing covers.
void choose(Site& site, const std::string& name);

/// Extends `options` for one cover of a bus: its serial numbers become assignments, the other covers neighbours. Throws
/// std::out_of_range where serials or addresses do not match the patches, which read_site excludes; the functions below
/// do the same.
[[nodiscard]] deploy::FlashOptions flash_options(const BusConfig& bus, const CoverConfig& cover,
                                                 deploy::FlashOptions options);

/// Returns the controllers of the bus that are not in `streamed`, because they stream as well
/// (session::StreamOptions::neighbours). Throws as flash_options.
[[nodiscard]] std::vector<session::StreamDemand> other_demands(const BusConfig& bus,
                                                               std::span<const design::Design* const> streamed);

/// Extends `options` for a stream of `streamed`: the other covers become neighbours, and the rate of the robot file is
/// used where `options` does not set one. Throws as flash_options.
[[nodiscard]] session::StreamOptions stream_options(const BusConfig& bus,
                                                    std::span<const design::Design* const> streamed,
                                                    session::StreamOptions options);

/// Joins all covers of a robot in the frame of its base (joints at 0), for pictures and exports; cover c of the robot
/// file is element c of the offsets. Throws as design::side_by_side does.
[[nodiscard]] design::SideBySide in_base(const Assembly& assembly);

}  // namespace triskin::robot
