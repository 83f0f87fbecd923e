// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <filesystem>
#include <string>

#include "triskin/check/design_rules.hpp"

namespace triskin::check {

/// What a file of `triskin place --lattices` claims; the layout keeps all rules when report.violations is empty.
struct FlatLayoutReport {
  DesignReport report;
  std::size_t lattices = 0;
  int upper_bound = 0;      ///< As the file states it.
  int own_upper_bound = 0;  ///< As the checker finds it, with code of its own.
  double gap_mm = 0.0, tolerance_mm = 0.0;
};

/// Returns true for text that claims to be such a file.
[[nodiscard]] bool is_flat_layout(const std::string& text);

/// Checks it: modules are those of the stated grids, lie in the outline and keep the gap, both within the tolerance, by
/// exact predicates; their number is the stated one, and the stated bound is proved by areas (docs/placement.md).
/// Shares no code with the solver. Errors: InputError naming `name` for text that cannot be read. Cost: O(modules ·
/// (modules + edges)), and some 0.1 s for the bound.
[[nodiscard]] FlatLayoutReport check_flat_layout(const std::string& text, const std::string& name);

}  // namespace triskin::check
