// SPDX-License-Identifier: GPL-3.0-or-later
// These functions compare the output shown in docs/ with what a program prints; "…" on the page matches any text.
#pragma once
#include <filesystem>
#include <regex>
#include <sstream>
#include <string>
#include <vector>

#include "support/places.hpp"
#include "triskin/base/files.hpp"

namespace triskin::test {

/// Returns the lines of the first block without a language after `mark` on the page docs/`page`.
inline std::vector<std::string> page_block(const std::string& page, const std::string& mark) {
  const std::string text = read_file(std::filesystem::path(source_folder()) / "docs" / page);
  const std::size_t from = text.find("```\n", text.find(mark)), to = text.find("```", from + 4);
  std::vector<std::string> lines;
  std::istringstream in(text.substr(from + 4, to - from - 4));
  for (std::string line; std::getline(in, line);) lines.push_back(line);
  return lines;
}

/// Returns true if a printed line matches a line of the page.
inline bool is_like(const std::string& wanted, const std::string& line) {
  std::string pattern;
  for (std::size_t at = 0; at < wanted.size();) {
    if (wanted.compare(at, std::string("…").size(), "…") == 0) {
      pattern += ".*";
      at += std::string("…").size();
    } else {
      if (std::string(".^$|()[]{}*+?\\").find(wanted[at]) != std::string::npos) pattern += '\\';
      pattern += wanted[at++];
    }
  }
  return std::regex_match(line, std::regex(pattern));
}

/// Returns the first line of `wanted` that `printed` lacks, in the order of the page, or an empty string if none.
inline std::string missing_line(const std::vector<std::string>& wanted, const std::string& printed) {
  std::istringstream lines(printed);
  for (const std::string& want : wanted) {
    bool found = false;
    for (std::string line; !found && std::getline(lines, line);) found = is_like(want, line);
    if (!found) return want;
  }
  return {};
}

}  // namespace triskin::test
