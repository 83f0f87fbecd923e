// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <charconv>
#include <string>
#include <string_view>

namespace triskin::mesh {

/// Decodes the percent-encoded bytes of a URI (RFC 3986, section 2.1); a % without two hexadecimal digits after it
/// stays. Cost: linear.
[[nodiscard]] inline std::string percent_decoded(std::string_view uri) {
  std::string text;
  for (std::size_t k = 0; k < uri.size(); ++k) {
    unsigned value = 0;
    const std::string_view digits = uri.substr(k + 1 < uri.size() ? k + 1 : uri.size(), 2);
    const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value, 16);
    const bool is_code = uri[k] == '%' && digits.size() == 2 && error == std::errc{} && end == digits.data() + 2;
    text += is_code ? static_cast<char>(value) : uri[k];
    k += is_code ? 2 : 0;
  }
  return text;
}

}  // namespace triskin::mesh
