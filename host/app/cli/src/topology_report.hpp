// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <nlohmann/json.hpp>
#include <string>
#include <utility>
#include <vector>

#include "command.hpp"
#include "triskin/design/design.hpp"
#include "triskin/session/controller.hpp"

namespace triskin::cli {

using NamedDesign = std::pair<std::string, design::Design>;  ///< The text is the name of the design's file.

/// Lets the controller search for its modules and joints; reports what it found, which patch of the designs this is,
/// and the differences. `expected_patch` is the patch of its table, in the design with id `expected_design`; −1 means
/// that it has no table.
[[nodiscard]] nlohmann::json report_topology(session::Controller& controller, const std::vector<NamedDesign>& designs,
                                             std::uint64_t expected_design, layout::PatchIndex expected_patch,
                                             const Output& output);

/// Returns true if something differs from the design of the table, or no design was recognized.
[[nodiscard]] bool differs(const nlohmann::json& topology);

}  // namespace triskin::cli
