// SPDX-License-Identifier: GPL-3.0-or-later
#include "error_words.hpp"

#include <fmt/format.h>

#include <array>
#include <cstdlib>
#include <regex>
#include <utility>

namespace triskin::cli {
namespace {

// The names of options end in their unit.
constexpr std::array<std::pair<const char*, const char*>, 9> kUnits{{{"-mm", " millimetres"},
                                                                     {"-ms", " milliseconds"},
                                                                     {"-us", " microseconds"},
                                                                     {"-s", " seconds"},
                                                                     {"-hz", " hertz"},
                                                                     {"-kpa", " kilopascals"},
                                                                     {"-deg", " degrees"},
                                                                     {"-percent", " percent"},
                                                                     {"-cm", " centimetres"}}};

std::string unit_of(const std::string& option) {
  if (option == "--seconds") return " seconds";
  for (const auto& [ending, unit] : kUnits)
    if (option.starts_with("--") && option.ends_with(ending)) return unit;
  return "";
}

std::string short_number(const std::string& text) {
  return fmt::format("{:.12g}", std::strtod(text.c_str(), nullptr));
}

}  // namespace

std::string plain_words(const std::string& message) {
  static const std::regex range(R"((.*?): Value (.*) not in range (\S+) to (\S+))");
  static const std::regex unread(R"(Could not convert: (\S+) = (.*))");
  static const std::regex missing(R"((.*?): (\d+) required (.*) missing)");
  static const std::regex choice(R"((.*?): (.*) not in \{(.*)\})");
  static const std::regex stranger(R"(The following arguments? (?:was|were) not expected: (.*))");
  std::smatch m;
  if (std::regex_match(message, m, range))
    return fmt::format("{}: {} is not between {} and {}{}", m.str(1), m.str(2), short_number(m[3]), short_number(m[4]),
                       unit_of(m[1]));
  if (std::regex_match(message, m, unread))
    return fmt::format("{}: {} is no number{}", m.str(1), m.str(2),
                       unit_of(m[1]).empty() ? "" : " (" + unit_of(m[1]).substr(1) + ")");
  if (std::regex_match(message, m, missing)) return fmt::format("{}: a value is missing", m.str(1));
  if (std::regex_match(message, m, choice)) return fmt::format("{}: {} is none of {}", m.str(1), m.str(2), m.str(3));
  if (std::regex_match(message, m, stranger)) return fmt::format("{} is not known here", m.str(1));
  return message;
}

}  // namespace triskin::cli
