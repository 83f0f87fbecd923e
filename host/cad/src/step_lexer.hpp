// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstdint>
#include <string>
#include <string_view>

namespace triskin::cad {

/// A token of a STEP file (ISO 10303-21).
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
  std::string_view text;  ///< It is the text in the file; for a string, what is between its quotes.
  std::string problem;    ///< It is the message of kBad, a sentence.

  [[nodiscard]] bool is_value() const { return kind >= Kind::kReference && kind <= Kind::kDerived; }
  /// Text in upper case.
  [[nodiscard]] std::string upper() const;
  /// Text for a message: no more than 24 characters, without control characters.
  [[nodiscard]] std::string shown() const;
};

/// Takes a STEP file apart; white space and comments fall away.
class StepLexer {
 public:
  explicit StepLexer(std::string_view bytes) : bytes_(bytes) {}

  /// The next token, kEnd for ever at the end; also kEnd where the file ends within a token.
  StepToken next();
  /// The next character that is neither white space nor comment, 0 at the end; nothing is taken.
  [[nodiscard]] char peek();
  [[nodiscard]] bool at_end() { return peek() == '\0' && at_ >= bytes_.size(); }
  /// Line of the last token, from 1. Cost: amortized linear.
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
