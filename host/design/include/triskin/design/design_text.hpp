// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <string>

#include "triskin/design/design.hpp"

namespace triskin::design {

/// read_design for the text of a design file; errors name it `file`.
[[nodiscard]] Design parse_design(const std::string& text, const std::string& file);

}  // namespace triskin::design
