// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <string>
#include <vector>

#include "triskin/design/design.hpp"
#include "triskin/robot/robot.hpp"

namespace triskin::robot {

/// Gives the patches of `cover` that have none a controller, at the lowest free node address in the range of their bus,
/// from `first_node` upwards (0: from the beginning of the range); removes controllers of patches that `design` does
/// not have; stores the design's id. Existing controllers keep address, serial number and bus, so that a changed design
/// does not affect the other boards. Throws InputError when the bus does not exist or has no free address.
void seat(Robot& robot, CoverEntry& cover, const design::Design& design, int first_node = 0);

/// Returns the cover `name`, or null. The pointer is valid until covers are added.
[[nodiscard]] CoverEntry* find_cover(Robot& robot, const std::string& name);

/// Parses a bus written as NAME=LINK or NAME=LINK@RATE[/DATA_RATE], bit/s, for example "left=can:can0@1000000/2000000".
/// Throws InputError.
[[nodiscard]] BusEntry parse_bus(const std::string& text);

}  // namespace triskin::robot
