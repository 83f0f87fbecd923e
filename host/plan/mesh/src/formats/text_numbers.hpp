// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <algorithm>
#include <optional>
#include <string>
#include <string_view>

namespace triskin::mesh {

inline constexpr std::string_view kBlanks = " \t\f\v";

/// Takes the next word off the front of `line`; returns an empty one at the end. Cost: linear in the word.
[[nodiscard]] inline std::string_view next_word(std::string_view& line) {
  line.remove_prefix(std::min(line.find_first_not_of(kBlanks), line.size()));
  const std::string_view word = line.substr(0, line.find_first_of(kBlanks));
  line.remove_prefix(word.size());
  return word;
}

/// Reads a decimal number in any notation that programs write: 1, -1.5, +2e3, and 1.5D+02 of Fortran. Returns nullopt
/// for anything else, also if bytes follow it. "nan" and "inf" are numbers here, so that a later step can name their
/// vertex.
[[nodiscard]] std::optional<double> decimal_number(std::string_view word);

/// Returns nullopt for anything but a whole number.
[[nodiscard]] std::optional<long> whole_number(std::string_view word);

/// Tells whether the word is a number with a decimal comma, as programs write it under some locales.
[[nodiscard]] bool has_decimal_comma(std::string_view word);

/// Splits text into lines that end with LF, CR or CRLF, also mixed in one text.
class LineReader {
 public:
  /// `text` must outlive the reader; a byte order mark of UTF-8 at its beginning is skipped.
  explicit LineReader(std::string_view text);
  /// Gives the next line without its end; false at the end of the text.
  [[nodiscard]] bool next(std::string_view& line);
  /// Returns the number of the line that next() gave, counted from 1.
  [[nodiscard]] int number() const { return number_; }
  /// Tells whether the line that next() gave had a line end.
  [[nodiscard]] bool has_end() const { return has_end_; }

 private:
  std::string_view rest_;
  int number_ = 0;
  bool has_end_ = true;
};

}  // namespace triskin::mesh
