// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <charconv>
#include <cmath>
#include <string>
#include <system_error>
#include <vector>

namespace triskin::cli {

/// Parses numbers separated by commas; the result is empty if the text has anything else.
[[nodiscard]] inline std::vector<double> numbers_of(const std::string& text) {
  std::vector<double> numbers;
  for (std::size_t from = 0; from <= text.size();) {
    const std::size_t end = std::min(text.find(',', from), text.size());
    double value = 0.0;
    const auto [rest, error] = std::from_chars(text.data() + from, text.data() + end, value);
    if (error != std::errc{} || rest != text.data() + end || !std::isfinite(value)) return {};
    numbers.push_back(value);
    from = end + 1;
  }
  return numbers;
}

}  // namespace triskin::cli
