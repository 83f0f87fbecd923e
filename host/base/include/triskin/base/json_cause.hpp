// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <string>
#include <string_view>

namespace triskin {

/// Shortens the message of a JSON parser for a person by removing the name and number of the exception's class
/// ("[json.exception.parse_error.101] parse error at line 1, column 5: …" becomes "line 1, column 5: …").
[[nodiscard]] inline std::string json_cause(std::string_view what) {
  if (what.starts_with("[json.exception")) {
    const auto end = what.find("] ");
    if (end != std::string_view::npos) what.remove_prefix(end + 2);
  }
  if (what.starts_with("parse error at ")) what.remove_prefix(std::string_view("parse error at ").size());
  std::string text(what);
  constexpr std::string_view kParsing = "syntax error while parsing ";
  if (const auto at = text.find(kParsing); at != std::string::npos) text.replace(at, kParsing.size(), "cannot read ");
  return text;
}

}  // namespace triskin
