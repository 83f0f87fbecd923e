// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "triskin/cli/command.hpp"
#include "triskin/design/design.hpp"
#include "triskin/session/bus.hpp"

namespace triskin::cli {

/// Says the offsets of the converters, a line a patch and one for each module with a taxel out of place, and returns
/// them as JSON. Asks the controllers. Throws as device::read_offsets().
nlohmann::json say_offsets(device::Bus& bus, const design::Design& design, const Output& output);

}  // namespace triskin::cli
