// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <string>
#include <string_view>

namespace triskin {

/// Escapes `text` for HTML, SVG or XML, also for an attribute in either kind of quotes: the characters &, <, >, " and '
/// become entities, tab and line ends become numbers, and characters that XML 1.0 forbids (control characters, bytes
/// that are no UTF-8, U+FFFE, U+FFFF) become U+FFFD. Not for the inside of a script or style element. Cost: linear.
/// Threads: any.
[[nodiscard]] std::string escape_markup(std::string_view text);

}  // namespace triskin
