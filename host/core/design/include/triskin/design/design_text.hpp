// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <string>

#include "triskin/design/design.hpp"

namespace triskin::design {

/// Does the same as read_design, but from text; error messages call it `file`.
[[nodiscard]] Design parse_design(const std::string& text, const std::string& file);

/// Returns the text that write_design() writes, for who judges it before it becomes a file. Cost: linear.
[[nodiscard]] std::string design_text(const Design& design);

}  // namespace triskin::design
