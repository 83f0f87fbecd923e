// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <span>
#include <string>
#include <vector>

#include "triskin/base/format_index.hpp"
#include "triskin/layout/index.hpp"

namespace triskin::cli {

/// Parses module ids and ranges of them: "3,7-9" gives 3, 7, 8, 9. Throws InputError that names the option for anything
/// else and for ids above 9,999,999.
[[nodiscard]] std::vector<layout::ModuleId> module_ids(const std::string& option, const std::string& text);

/// Writes ids, which are in ascending order, as module_ids() reads them.
[[nodiscard]] std::string module_ids_text(std::span<const layout::ModuleId> ids);

}  // namespace triskin::cli
