// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <string_view>

namespace triskin::geometry {

/// Value of an attribute of an XML tag; `inside` is the text between < and >. `name` follows a space or, for names of
/// any namespace, begins with a colon. Empty where the tag has none. Cost: linear.
[[nodiscard]] inline std::string_view attribute_of(std::string_view inside, std::string_view name) {
  constexpr std::string_view kSpace = " \t\r\n";
  for (std::size_t at = inside.find(name, 1); at != std::string_view::npos; at = inside.find(name, at + 1)) {
    const std::size_t sign = inside.find_first_not_of(kSpace, at + name.size());
    const bool is_whole = name.front() == ':' || kSpace.contains(inside[at - 1]);
    if (!is_whole || sign == std::string_view::npos || inside[sign] != '=') continue;
    const std::size_t quote = inside.find_first_of("\"'", sign);
    if (quote == std::string_view::npos) return {};
    const std::size_t end = inside.find(inside[quote], quote + 1);
    return end == std::string_view::npos ? std::string_view() : inside.substr(quote + 1, end - quote - 1);
  }
  return {};
}

}  // namespace triskin::geometry
