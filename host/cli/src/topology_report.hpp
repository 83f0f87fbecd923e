// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <nlohmann/json.hpp>
#include <string>
#include <utility>
#include <vector>

#include "triskin/cli/command.hpp"
#include "triskin/design/design.hpp"
#include "triskin/session/controller.hpp"

namespace triskin::cli {

using NamedDesign = std::pair<std::string, design::Design>;  ///< Each is a file and its design.

/// Lets the controller look for its modules and joints; says what it found, which patch of the designs that is, and
/// what differs. `expected_patch`: of the design with id `expected_design`, that its table is for; −1: it has none.
[[nodiscard]] nlohmann::json report_topology(device::Controller& controller, const std::vector<NamedDesign>& designs,
                                             std::uint64_t expected_design, int expected_patch, const Output& output);

/// Something differs from the design that the table is for, or no design was recognized.
[[nodiscard]] bool differs(const nlohmann::json& topology);

}  // namespace triskin::cli
