// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <algorithm>
#include <optional>
#include <string>
#include <string_view>

namespace triskin::geometry {

inline constexpr std::string_view kBlanks = " \t\f\v";

/// Takes the next word off the front of `line`; empty when none is left. Cost: linear in the word.
[[nodiscard]] inline std::string_view next_word(std::string_view& line) {
  line.remove_prefix(std::min(line.find_first_not_of(kBlanks), line.size()));
  const std::string_view word = line.substr(0, line.find_first_of(kBlanks));
  line.remove_prefix(word.size());
  return word;
}

/// A decimal number in any notation that programs write: 1, -1.5, +2e3, and 1.5D+02 of Fortran. nullopt for anything
/// else, also where bytes follow it. "nan" and "inf" are numbers here, so that a later step can name their vertex.
[[nodiscard]] std::optional<double> decimal_number(std::string_view word);

/// A whole number. nullopt for anything else.
[[nodiscard]] std::optional<long> whole_number(std::string_view word);

/// Is the word a number whose decimal sign is a comma, as programs write it under some languages?
[[nodiscard]] bool has_decimal_comma(std::string_view word);

/// Lines that end with LF, CR or CRLF, also mixed in one text.
class LineReader {
 public:
  /// `text` outlives the reader; a byte order mark of UTF-8 at its beginning is skipped.
  explicit LineReader(std::string_view text);
  /// The next line without its end; false when the text is over.
  [[nodiscard]] bool next(std::string_view& line);
  /// Number of the line that next() gave, 1-based.
  [[nodiscard]] int number() const { return number_; }
  /// Did the line that next() gave have a line end?
  [[nodiscard]] bool has_end() const { return has_end_; }

 private:
  std::string_view rest_;
  int number_ = 0;
  bool has_end_ = true;
};

}  // namespace triskin::geometry
