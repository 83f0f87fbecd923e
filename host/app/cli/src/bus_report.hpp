// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstddef>

#include "command.hpp"

namespace triskin::cli {

/// Adds the load of one bus by all samples of `modules` modules at the controllers' bit rates as the key "bus":
/// "can_fd" (every sample of the full stream, 1 = the whole bus), "every" (the smallest n for which each n-th sample
/// fits) and "icub" (the iCub stream at 50 ms on a classic bus).
void add_bus_keys(std::size_t modules, Output& output);
/// Adds that key, and says what fits if not every sample does.
void report_bus(std::size_t modules, Output& output);

}  // namespace triskin::cli
