// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <string>
#include <string_view>

namespace triskin {

/// `text` with the characters &, <, > and " as entities, so that it can stand in HTML or XML, also in an attribute.
/// Others stay, control characters too. Cost: linear. Threads: any.
[[nodiscard]] std::string escape_markup(std::string_view text);

}  // namespace triskin
