// SPDX-License-Identifier: GPL-3.0-or-later
#include "triskin/base/ascii_name.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstdint>

namespace triskin {
namespace {

constexpr std::size_t kHashDigits = 8;

// A name that ends as one with a hash does gets a hash of its own, or two names could become one.
bool ends_in_hash(std::string_view text) {
  if (text.size() <= kHashDigits || text[text.size() - kHashDigits - 1] != '_') return false;
  return text.substr(text.size() - kHashDigits).find_first_not_of("0123456789abcdef") == std::string_view::npos;
}

bool is_digit(char c) {
  return c >= '0' && c <= '9';
}

bool stands(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || is_digit(c) || c == '_';
}

}  // namespace

std::string ascii_name(std::string_view text, std::string_view also, std::string_view if_empty) {
  std::string name;
  bool has_lost = ends_in_hash(text);
  std::uint32_t hash = 2166136261U;  // FNV-1a of 32 bits
  for (const char c : text) {
    const bool stays = stands(c) || also.find(c) != std::string_view::npos;
    has_lost = has_lost || !stays;
    name += stays ? c : '_';
    hash = (hash ^ static_cast<std::uint8_t>(c)) * 16777619U;
  }
  if (name.empty()) return std::string(if_empty);
  return has_lost ? fmt::format("{}_{:08x}", name, hash) : name;
}

bool is_part_name(std::string_view text) {
  return !text.empty() && !is_digit(text.front()) && std::ranges::all_of(text, stands);
}

std::string part_name(std::string_view text) {
  const std::string name = ascii_name(text, "", "p");
  return is_digit(name[0]) ? "p" + name : name;
}

}  // namespace triskin
