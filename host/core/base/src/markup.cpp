// SPDX-License-Identifier: GPL-3.0-or-later
#include "triskin/base/markup.hpp"

#include "triskin/base/terminal_text.hpp"

namespace triskin {
namespace {

std::string_view entity_of(char32_t c) {
  switch (c) {
    case '&':
      return "&amp;";
    case '<':
      return "&lt;";
    case '>':
      return "&gt;";
    case '"':
      return "&quot;";
    case '\'':
      return "&#39;";
    // A parser would read white space in an attribute as a blank (XML 1.0, section 3.3.3).
    case '\t':
      return "&#9;";
    case '\n':
      return "&#10;";
    case '\r':
      return "&#13;";
    default:
      return {};
  }
}

// Allows the characters of XML 1.0, section 2.2, without the controls of the second block, which HTML refuses.
bool is_in_markup(char32_t c) {
  if (c < 0x20) return c == '\t' || c == '\n' || c == '\r';
  return (c < 0x7F || c > 0x9F) && c != 0xFFFE && c != 0xFFFF;
}

}  // namespace

std::string escape_markup(std::string_view text) {
  constexpr std::string_view kReplacement = "\xEF\xBF\xBD";
  std::string out;
  for (std::size_t at = 0; at < text.size();) {
    const Utf8Character c = utf8_at(text, at);
    if (c.bytes == 0 || !is_in_markup(c.code))
      out += kReplacement;
    else if (const std::string_view entity = entity_of(c.code); !entity.empty())
      out += entity;
    else
      out += text.substr(at, c.bytes);
    at += c.bytes == 0 ? 1 : c.bytes;
  }
  return out;
}

}  // namespace triskin
