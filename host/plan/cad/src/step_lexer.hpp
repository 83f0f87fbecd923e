// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstdint>
#include <string>
#include <string_view>

namespace triskin::cad {

struct StepToken {
  enum class Kind : std::uint8_t {
    kEnd,
    kBad,
    kKeyword,
    kReference,
    kNumber,
    kString,
    kEnumeration,
    kBinary,
    kOmitted,
    kDerived,
    kOpen,
    kClose,
    kComma,
    kEquals,
    kSemicolon,
  };
  Kind kind = Kind::kEnd;
  std::string_view text;  ///< The text is that of the file; for a string, only the part between its quotes.
  std::string problem;    ///< A kBad token has its message here, as a sentence.

  [[nodiscard]] bool is_value() const { return kind >= Kind::kReference && kind <= Kind::kDerived; }
  /// Returns the text in upper case.
  [[nodiscard]] std::string upper() const;
  /// Returns the text for a message: no more than 24 characters, without control characters.
  [[nodiscard]] std::string shown() const;
};

/// Splits a STEP file into tokens and skips white space and comments.
class StepLexer {
 public:
  explicit StepLexer(std::string_view bytes) : bytes_(bytes) {}

  /// Returns the next token, and kEnd at every call after the end; also kEnd if the file ends within a token.
  StepToken next();
  /// Returns the next character that is neither white space nor comment, 0 at the end, without consuming it.
  [[nodiscard]] char peek();
  [[nodiscard]] bool at_end() { return peek() == '\0' && at_ >= bytes_.size(); }
  /// Skips to behind the next `ENDSEC;` and returns what stands before it; null data if there is none.
  [[nodiscard]] std::string_view skip_section();
  /// Returns the line of the last token, counted from 1. Cost: amortized linear.
  [[nodiscard]] std::size_t line() const;

 private:
  void skip_blanks();
  StepToken take(StepToken::Kind kind, std::size_t length);
  StepToken bad(std::string problem) const {
    return {StepToken::Kind::kBad, bytes_.substr(at_, 1), std::move(problem)};
  }
  StepToken quoted(char quote, StepToken::Kind kind);
  StepToken enumeration();
  StepToken number();
  StepToken word();
  [[nodiscard]] std::size_t run_of(bool (*is_in)(unsigned char), std::size_t from) const;

  std::string_view bytes_;
  std::size_t at_ = 0, token_at_ = 0;
};

}  // namespace triskin::cad
