// SPDX-License-Identifier: GPL-3.0-or-later
#include "triskin/base/csv_field.hpp"

namespace triskin {

std::string csv_field(std::string_view text) {
  const bool is_formula = !text.empty() && std::string_view("=+-@\t\r").find(text.front()) != std::string_view::npos;
  std::string value(is_formula ? 1 : 0, '\'');
  value += text;
  const bool has_edge = !text.empty() && (text.front() == ' ' || text.back() == ' ');
  if (!has_edge && value.find_first_of(",\"\r\n") == std::string::npos) return value;
  std::string quoted = "\"";
  for (const char c : value) quoted.append(c == '"' ? 2 : 1, c);
  quoted += '"';
  return quoted;
}

}  // namespace triskin
