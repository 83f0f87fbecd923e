// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <string>

#include "command.hpp"
#include "triskin/design/design.hpp"

namespace triskin::cli {

/// Explains why no module fits: which limit refuses modules where, and what would help. Adds the obstacle to the
/// result. `unit_given` says that the user named the unit. Cost: that of lattice::what_refuses().
[[nodiscard]] std::string reason_of_nothing(const design::Design& design, bool unit_given, Output& output);

/// If much of the surface stays uncovered, says which limit refused most and what would join islands. Empty if coverage
/// is sufficient.
[[nodiscard]] std::string low_coverage_text(const design::Design& design);

}  // namespace triskin::cli
