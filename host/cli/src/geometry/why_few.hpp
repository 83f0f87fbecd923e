// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <string>

#include "triskin/cli/command.hpp"
#include "triskin/design/design.hpp"

namespace triskin::cli {

/// Why no module fits: which limit refuses where, and what would help. Adds the obstacle to the result. `unit_given`:
/// the user has said the unit. Cost: that of geometry::what_refuses().
[[nodiscard]] std::string reason_of_nothing(const design::Design& design, bool unit_given, Output& output);

/// Where much of the surface stays bare: which limit refused most, and what joins islands. Empty: enough is covered.
[[nodiscard]] std::string low_coverage_text(const design::Design& design);

}  // namespace triskin::cli
