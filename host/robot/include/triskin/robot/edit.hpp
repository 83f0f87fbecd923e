// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <string>
#include <vector>

#include "triskin/design/design.hpp"
#include "triskin/robot/robot.hpp"

namespace triskin::robot {

/// Gives the patches of `cover` that have none a controller, at the lowest free node address of the range of their bus,
/// from `first_node` upwards (0: from the beginning of the range); drops controllers of patches that `design` does not
/// have; notes the design's id. Controllers that are there keep address, serial number and bus, so that a changed
/// design leaves the other boards as they are. Throws InputError when the bus is not there or has no free address.
void seat(Robot& robot, CoverEntry& cover, const design::Design& design, int first_node = 0);

/// The cover `name`; null: there is none. Valid until covers are added.
[[nodiscard]] CoverEntry* find_cover(Robot& robot, const std::string& name);

/// Bus written as NAME=LINK or NAME=LINK@RATE[/DATA_RATE], bit/s, for example "left=can:can0@1000000/2000000". Throws
/// InputError.
[[nodiscard]] BusEntry parse_bus(const std::string& text);

}  // namespace triskin::robot
