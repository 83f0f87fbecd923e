// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <string>

#include "triskin/design/design.hpp"

namespace triskin::diagnose {

/// Describes the place of a module on its cover by the rows of the lattice as the assembly sheet draws them: "island 0,
/// row 3 of 9, left rim". Rows are counted from below, modules from the left. Cost: O(modules). Throws
/// std::out_of_range for a module that the design lacks.
[[nodiscard]] std::string place_on_cover(const design::Design& design, layout::ModuleId module);

/// Names a joint: "the joint of module 4 (side 1) and module 5 (side 2)", with sides numbered as on the sheet; if the
/// modules are not neighbours, sides are left out. Throws std::out_of_range for a module that the design lacks.
[[nodiscard]] std::string joint_text(const design::Design& design, layout::ModuleId module, layout::ModuleId other);

}  // namespace triskin::diagnose
