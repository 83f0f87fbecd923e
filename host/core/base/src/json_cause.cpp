// SPDX-License-Identifier: GPL-3.0-or-later
#include "triskin/base/json_cause.hpp"

#include <fmt/format.h>

#include <array>
#include <optional>

namespace triskin {
namespace {

struct Cause {
  std::string_view library;  // The library's message contains this text (nlohmann-json 3.11).
  std::string_view words;
};

// The order matters, since the first matching cause is used.
constexpr std::array<Cause, 14> kCauses{{
    {"unexpected end of input", "the text ends in the middle: it was cut, or a bracket is missing"},
    {"empty input", "the text is empty"},
    {"missing closing quote", "a quote is never closed: the text was cut, or the quote is missing"},
    {"control character", "a line end or control character between quotes: a closing quote is missing before it"},
    {"ill-formed UTF-8", "a byte that is not UTF-8: the file is damaged or in another encoding"},
    {"invalid string", "a backslash followed by what JSON does not allow"},
    {"invalid number", "a malformed number"},
    {"number overflow", "a number is out of range"},
    {"invalid literal", "neither number, text in quotes, true, false nor null (JSON has no nan and no inf)"},
    {"expected end of input", "more follows behind the end of the JSON"},
    {"out of range", "a list is too short"},
    {"type must be", "a value is of another type than it should be"},
    {"cannot use", "a value is of another type than it should be"},
    {"incompatible", "a value is of another type than it should be"},
}};

std::optional<std::string_view> between(std::string_view text, std::string_view before, std::string_view behind) {
  const std::size_t begin = text.find(before);
  if (begin == std::string_view::npos) return std::nullopt;
  text.remove_prefix(begin + before.size());
  return text.substr(0, text.find(behind));
}

std::string words_of_cause(std::string_view what) {
  for (const Cause& cause : kCauses) {
    if (what.find(cause.library) != std::string_view::npos) return std::string(cause.words);
  }
  if (const auto key = between(what, "key '", "' not found")) return fmt::format("the key \"{}\" is missing", *key);
  if (const auto token = between(what, "unexpected ", ";")) return fmt::format("unexpected {}", *token);
  return "not what this file must be";
}

}  // namespace

bool begins_as_json_object(std::string_view text) {
  const std::size_t first = text.find_first_not_of(" \t\r\n");
  return first != std::string_view::npos && text[first] == '{';
}

std::string json_cause(std::string_view what) {
  const auto place = between(what, "parse error at ", ": ");
  return place ? fmt::format("{}: {}", *place, words_of_cause(what)) : words_of_cause(what);
}

}  // namespace triskin
