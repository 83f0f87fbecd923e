// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstddef>

#include "triskin/cli/command.hpp"

namespace triskin::cli {

/// What all samples of `modules` modules take of one bus at the controllers' bit rates, as the key "bus":
/// "can_fd" (every sample of the full stream, 1 = all of the bus), "every" (the smallest n whose n-th samples fit) and
/// "icub" (the iCub stream at 50 ms on a classic bus).
void add_bus_keys(std::size_t modules, Output& output);
/// Adds that key, and says what fits when every sample does not.
void report_bus(std::size_t modules, Output& output);

}  // namespace triskin::cli
