// SPDX-License-Identifier: GPL-3.0-or-later
#include "text_numbers.hpp"

#include <charconv>

namespace triskin::mesh {
namespace {

template <class Number>
std::optional<Number> whole_of(std::string_view word) {
  Number value{};
  const auto [rest, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (error != std::errc{} || rest != word.data() + word.size()) return std::nullopt;
  return value;
}

std::string_view without_plus(std::string_view word) {
  const bool has_plus = word.size() > 1 && word.front() == '+' && word[1] != '-' && word[1] != '+';
  return has_plus ? word.substr(1) : word;
}

}  // namespace

std::optional<double> decimal_number(std::string_view word) {
  word = without_plus(word);
  if (const auto value = whole_of<double>(word)) return value;
  const std::size_t exponent = word.find_first_of("dD");
  if (exponent == 0 || exponent == std::string_view::npos) return std::nullopt;
  std::string text(word);
  text[exponent] = 'e';
  if (exponent + 1 < text.size() && text[exponent + 1] == '+') text.erase(exponent + 1, 1);
  return whole_of<double>(text);
}

std::optional<long> whole_number(std::string_view word) {
  return whole_of<long>(without_plus(word));
}

bool has_decimal_comma(std::string_view word) {
  if (std::ranges::count(word, ',') != 1) return false;
  std::string text(word);
  text[text.find(',')] = '.';
  return decimal_number(text).has_value();
}

LineReader::LineReader(std::string_view text) : rest_(text) {
  constexpr std::string_view kByteOrderMark = "\xEF\xBB\xBF";
  if (rest_.starts_with(kByteOrderMark)) rest_.remove_prefix(kByteOrderMark.size());
}

bool LineReader::next(std::string_view& line) {
  if (rest_.empty()) return false;
  const std::size_t end = std::min(rest_.find_first_of("\r\n"), rest_.size());
  line = rest_.substr(0, end);
  has_end_ = end < rest_.size();
  const bool is_pair = rest_.substr(end, 2) == "\r\n";
  rest_.remove_prefix(std::min(end + (is_pair ? 2 : 1), rest_.size()));
  ++number_;
  return true;
}

}  // namespace triskin::mesh
