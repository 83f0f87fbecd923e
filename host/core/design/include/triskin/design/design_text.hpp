// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <string>

#include "triskin/design/design.hpp"

namespace triskin::design {

/// Does the same as read_design, but from text; error messages call it `file`.
[[nodiscard]] Design parse_design(const std::string& text, const std::string& file);

}  // namespace triskin::design
