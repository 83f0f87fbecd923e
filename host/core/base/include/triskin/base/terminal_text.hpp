// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <string>
#include <string_view>

namespace triskin {

/// Makes `text` safe for a terminal: control characters other than line feed and tabulator, those of Unicode that
/// change the direction of text, and bytes that are no UTF-8 become visible as \x1B or \u202E. A name in a file can
/// thus not move the cursor, change colours, set the title or hide what was printed. Cost: linear. Threads: any.
[[nodiscard]] std::string for_terminal(std::string_view text);

/// Gives the code point of the UTF-8 character at `text[at]` and its number of bytes; 0 bytes mean that there is no
/// UTF-8 (also overlong forms, surrogates). Constant cost.
struct Utf8Character {
  char32_t code = 0;
  std::size_t bytes = 0;
};
[[nodiscard]] Utf8Character utf8_at(std::string_view text, std::size_t at);

}  // namespace triskin
