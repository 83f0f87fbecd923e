// SPDX-License-Identifier: GPL-3.0-or-later
#include "step_lexer.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace triskin::cad {
namespace {

constexpr std::size_t kShown = 24;

// The tests of the C library depend on the locale.
bool is_digit(unsigned char c) {
  return c >= '0' && c <= '9';
}
bool is_letter(unsigned char c) {
  return (c >= 'A' && c <= 'Z') || (c >= 'a' && c <= 'z');
}
bool is_word(unsigned char c) {
  return is_letter(c) || is_digit(c) || c == '_' || c == '-';
}
bool is_name(unsigned char c) {
  return is_letter(c) || is_digit(c) || c == '_';
}
bool is_one_of(std::string_view wanted, std::string_view bytes, std::size_t at) {
  return at < bytes.size() && wanted.find(bytes[at]) != std::string_view::npos;
}
bool is_blank(unsigned char c) {
  return c == ' ' || (c >= '\t' && c <= '\r');
}

}  // namespace

std::string StepToken::upper() const {
  std::string out(text);
  std::ranges::transform(out, out.begin(), [](char c) { return c >= 'a' && c <= 'z' ? static_cast<char>(c - 32) : c; });
  return out;
}

std::string StepToken::shown() const {
  std::string out;
  for (const char c : text.substr(0, kShown)) out += c >= ' ' && c < 0x7F ? c : '?';
  return text.size() > kShown ? out + "…" : out;
}

void StepLexer::skip_blanks() {
  for (;;) {
    while (at_ < bytes_.size() && is_blank(static_cast<unsigned char>(bytes_[at_]))) ++at_;
    if (!bytes_.substr(at_).starts_with("/*")) return;
    const std::size_t end = bytes_.find("*/", at_ + 2);
    at_ = end == std::string_view::npos ? bytes_.size() : end + 2;
  }
}

char StepLexer::peek() {
  skip_blanks();
  return at_ < bytes_.size() ? bytes_[at_] : '\0';
}

std::string_view StepLexer::skip_section() {
  constexpr std::string_view kEnd = "ENDSEC;";
  const std::size_t end = bytes_.find(kEnd, at_);
  if (end == std::string_view::npos) return {};
  const std::string_view contents = bytes_.substr(at_, end - at_);
  at_ = end + kEnd.size();
  return contents;
}

std::size_t StepLexer::line() const {
  return 1 + static_cast<std::size_t>(
                 std::count(bytes_.begin(), bytes_.begin() + static_cast<std::ptrdiff_t>(token_at_), '\n'));
}

std::size_t StepLexer::run_of(bool (*is_in)(unsigned char), std::size_t from) const {
  std::size_t end = from;
  while (end < bytes_.size() && is_in(static_cast<unsigned char>(bytes_[end]))) ++end;
  return end - from;
}

StepToken StepLexer::take(StepToken::Kind kind, std::size_t length) {
  const StepToken token{kind, bytes_.substr(at_, length), {}};
  at_ += length;
  return token;
}

StepToken StepLexer::quoted(char quote, StepToken::Kind kind) {
  std::size_t end = at_ + 1;
  for (; end < bytes_.size(); ++end) {
    if (bytes_[end] != quote) continue;
    if (quote == '\'' && end + 1 < bytes_.size() && bytes_[end + 1] == quote)
      ++end;
    else
      break;
  }
  if (end >= bytes_.size()) return {};
  const bool keeps_quotes = kind == StepToken::Kind::kBinary;
  const StepToken token{
      kind, keeps_quotes ? bytes_.substr(at_, end + 1 - at_) : bytes_.substr(at_ + 1, end - at_ - 1), {}};
  at_ = end + 1;
  return token;
}

StepToken StepLexer::enumeration() {
  const std::size_t length = run_of(is_name, at_ + 1);
  if (at_ + 1 + length >= bytes_.size()) return {};
  if (length == 0 || bytes_[at_ + 1 + length] != '.') return bad("a value like .T. is not closed by its second point");
  return take(StepToken::Kind::kEnumeration, length + 2);
}

StepToken StepLexer::number() {
  std::size_t length = is_one_of("+-", bytes_, at_) ? 1 : 0;
  const std::size_t digits = run_of(is_digit, at_ + length);
  length += digits;
  std::size_t decimals = 0;
  if (is_one_of(".", bytes_, at_ + length)) {
    decimals = run_of(is_digit, at_ + length + 1);
    length += 1 + decimals;
  }
  if (digits + decimals == 0) return word();
  if (is_one_of("Ee", bytes_, at_ + length)) {
    length += is_one_of("+-", bytes_, at_ + length + 1) ? 2 : 1;
    const std::size_t exponent = run_of(is_digit, at_ + length);
    if (exponent == 0) return bad("a number has no digits after its E");
    length += exponent;
  }
  return take(StepToken::Kind::kNumber, length);
}

// Also accepts -inf and the like, which no file may have; they are refused where a value is expected.
StepToken StepLexer::word() {
  return take(StepToken::Kind::kKeyword, std::max<std::size_t>(1, 1 + run_of(is_word, at_ + 1)));
}

StepToken StepLexer::next() {
  using Kind = StepToken::Kind;
  skip_blanks();
  token_at_ = at_;
  if (at_ >= bytes_.size()) return {};
  const char c = bytes_[at_];
  const auto byte = static_cast<unsigned char>(c);
  switch (c) {
    case '(':
      return take(Kind::kOpen, 1);
    case ')':
      return take(Kind::kClose, 1);
    case ',':
      return take(Kind::kComma, 1);
    case '=':
      return take(Kind::kEquals, 1);
    case ';':
      return take(Kind::kSemicolon, 1);
    case '$':
      return take(Kind::kOmitted, 1);
    case '*':
      return take(Kind::kDerived, 1);
    case '\'':
      return quoted('\'', Kind::kString);
    case '"':
      return quoted('"', Kind::kBinary);
    default:
      break;
  }
  if (c == '#') {
    const std::size_t digits = run_of(is_digit, at_ + 1);
    return digits > 0 ? take(Kind::kReference, digits + 1) : bad("a `#` has no number");
  }
  if (is_digit(byte) || c == '+' || c == '-') return number();
  if (c == '.')
    return at_ + 1 < bytes_.size() && is_digit(static_cast<unsigned char>(bytes_[at_ + 1])) ? number() : enumeration();
  if (is_letter(byte) || c == '!' || c == '_') return word();
  return bad(fmt::format("the byte 0x{:02X} has no place outside of a string; the file is damaged", byte));
}

}  // namespace triskin::cad
