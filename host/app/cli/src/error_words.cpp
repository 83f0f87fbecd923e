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

bool is_number(const std::string& text) {
  char* end = nullptr;
  (void)std::strtod(text.c_str(), &end);
  return !text.empty() && end == text.c_str() + text.size();
}

std::string no_number(const std::string& option, const std::string& value) {
  const std::string unit = unit_of(option);
  return fmt::format("{}: {} is not a number{}", option, value, unit.empty() ? "" : " (" + unit.substr(1) + ")");
}

// Turns "a,b" and "a->0,b->1" into "a, b".
std::string names_of(const std::string& choices) {
  static const std::regex value("->[^,]*"), comma(",");
  return std::regex_replace(std::regex_replace(choices, value, ""), comma, ", ");
}

// The library lists what it does not know from the last word to the first, an option behind its value.
std::string unknown_word(const std::string& words) {
  static const std::regex option(R"((?:^| )(-[-A-Za-z][^ =]*))");
  std::string first = words;
  for (std::sregex_iterator at(words.begin(), words.end(), option), end; at != end; ++at) first = (*at)[1];
  return first;
}

}  // namespace

std::string plain_words(const std::string& message) {
  static const std::regex range(R"((.*?): Value (.*) not in range (\S+) to (\S+))");
  static const std::regex unread(R"(Could not convert: (\S+) = (.*))");
  static const std::regex missing(R"((.*?): (\d+) required (.*) missing)");
  static const std::regex count(R"((.*?): At (?:least|most|Most) (\d+) required but received (\d+))");
  static const std::regex choice(R"((.*?): (?:Check )?(.*?) (?:value |not )in \{(.*?)\}.*)");
  static const std::regex stranger(R"(The following arguments? (?:was|were) not expected: (.*))");
  std::smatch m;
  static const std::regex required("(.*) is required"), excludes("(.*) excludes (.*)"),
      requires_other("(.*) requires (.*)");
  for (const std::regex* named : {&range, &unread, &choice}) {
    if (std::regex_match(message, m, *named) && m.str(2).empty())
      return fmt::format("{}: the value is empty", m.str(1));
  }
  if (message == "--output is required") return "-o FILE is missing: where the result goes";
  if (std::regex_match(message, m, required)) return fmt::format("{} is missing", m.str(1));
  if (std::regex_match(message, m, excludes)) return fmt::format("{} and {} cannot stand together", m.str(1), m.str(2));
  if (std::regex_match(message, m, requires_other)) return fmt::format("{} needs {} too", m.str(1), m.str(2));
  if (std::regex_match(message, m, range))
    return is_number(m[2]) ? fmt::format("{}: {} is not between {} and {}{}", m.str(1), m.str(2), short_number(m[3]),
                                         short_number(m[4]), unit_of(m[1]))
                           : no_number(m[1], m[2]);
  if (std::regex_match(message, m, unread))
    return is_number(m[2]) ? fmt::format("{}: {} is not a whole number, or too large", m.str(1), m.str(2))
                           : no_number(m[1], m[2]);
  if (std::regex_match(message, m, count))
    return fmt::format("{}: {} values are needed, {} given", m.str(1), m.str(2), m.str(3));
  if (std::regex_match(message, m, missing)) return fmt::format("{}: a value is missing", m.str(1));
  if (std::regex_match(message, m, choice))
    return fmt::format("{}: {} is none of {}", m.str(1), m.str(2), names_of(m[3]));
  if (std::regex_match(message, m, stranger)) return fmt::format("{} is not known here", unknown_word(m[1]));
  return message;
}

}  // namespace triskin::cli
