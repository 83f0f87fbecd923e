// SPDX-License-Identifier: GPL-3.0-or-later
#include "triskin/sheet/page_code.hpp"

#include <fmt/format.h>

#include <charconv>

namespace triskin::sheet {
namespace {

constexpr std::string_view kPrefix = "triskin:";
constexpr std::size_t kIdDigits = 16;

template <class Number>
std::optional<Number> read_number(std::string_view text, int base, Number least, Number most) {
  Number value{};
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value, base);
  if (text.empty() || error != std::errc() || end != text.data() + text.size() || value < least || value > most)
    return {};
  return value;
}

}  // namespace

std::string text_of(const PageCode& code) {
  const std::string patch = code.patch < 0 ? "-" : std::to_string(code.patch);
  return fmt::format("{}{:016x}/{}/{}", kPrefix, code.design_id, patch, code.page);
}

bool is_page_code(std::string_view text) {
  return text.starts_with(kPrefix);
}

std::optional<PageCode> read_page_code(std::string_view text) {
  if (!is_page_code(text)) return {};
  text.remove_prefix(kPrefix.size());
  const std::size_t first = text.find('/'), second = text.find('/', first + 1);
  if (first != kIdDigits || second == std::string_view::npos) return {};
  const auto id = read_number<std::uint64_t>(text.substr(0, first), 16, 0, ~std::uint64_t{0});
  const std::string_view patch_text = text.substr(first + 1, second - first - 1);
  const auto patch = patch_text == "-" ? std::optional(-1) : read_number<int>(patch_text, 10, 0, 65535);
  const auto page = read_number<int>(text.substr(second + 1), 10, 1, 65535);
  if (!id || !patch || !page) return {};
  return PageCode{*id, *patch, *page};
}

}  // namespace triskin::sheet
