// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <string>
#include <string_view>

namespace triskin {

/// `text` so that it can stand in HTML, SVG or XML, also in an attribute in either kind of quotes: the characters &, <,
/// >, " and ' as entities, tab and line ends as numbers, and what XML 1.0 cannot hold (control characters, bytes that
/// are no UTF-8, U+FFFE, U+FFFF) as U+FFFD. Not for the inside of a script or style element. Cost: linear. Threads:
/// any.
[[nodiscard]] std::string escape_markup(std::string_view text);

}  // namespace triskin
