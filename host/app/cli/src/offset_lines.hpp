// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "triskin/design/design.hpp"
#include "triskin/session/bus.hpp"

namespace triskin::cli {

/// Reads the offsets of the converters from the controllers and returns them as JSON. Appends text for a person to
/// `lines`: a line for each patch and one for each module with a taxel out of range. Throws as
/// session::read_offsets().
nlohmann::json read_offset_lines(session::Bus& bus, const design::Design& design, std::vector<std::string>& lines);

}  // namespace triskin::cli
