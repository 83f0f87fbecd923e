// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cctype>
#include <filesystem>
#include <string>
#include <string_view>

namespace triskin {

/// Converts ASCII letters to lower case and leaves other bytes unchanged.
[[nodiscard]] inline std::string lower_case(std::string_view text) {
  std::string result(text);
  for (char& c : result) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return result;
}

/// Returns the extension of a file name in lower case, with the dot; empty if it has none.
[[nodiscard]] inline std::string extension_of(const std::filesystem::path& path) {
  return lower_case(path.extension().string());
}

}  // namespace triskin
