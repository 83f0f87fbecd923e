// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <span>
#include <string>
#include <vector>

#include "triskin/design/design.hpp"
#include "triskin/layout/index.hpp"

namespace triskin::cli {

/// Returns the modules that a person names by their numbers: "3,7-9" are 3, 7, 8 and 9, without those that the design
/// lacks between 7 and 9. Throws InputError that names the option for anything else, and for a number or the end of a
/// range that the design lacks.
[[nodiscard]] std::vector<layout::ModuleId> modules_named(const design::Design& design, const std::string& option,
                                                          const std::string& text);

/// Writes modules, which are in ascending order, as modules_named() reads them.
[[nodiscard]] std::string modules_text(const design::Design& design, std::span<const layout::ModuleId> ids);

}  // namespace triskin::cli
