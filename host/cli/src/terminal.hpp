// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <string>
#include <vector>

namespace triskin::cli {

/// A terminal shows pages and reads single keys. Its former contents are restored afterwards.
class Terminal {
 public:
  /// Returns true when standard output is a terminal that can move its cursor.
  [[nodiscard]] static bool there();
  /// TERM says that the terminal cannot move its cursor, or is not set, so that nobody knows.
  [[nodiscard]] static bool is_dumb();
  /// Colours are wanted: the user did not set NO_COLOR (https://no-color.org).
  [[nodiscard]] static bool has_colour();
  /// Size of the screen in characters.
  struct Size {
    int columns = 80, rows = 24;  ///< Terminals that do not report their size are assumed to have this one.
  };
  /// Of the terminal that a file descriptor is, by default standard output.
  [[nodiscard]] static Size size(int descriptor = 1);
  /// At most one at a time. While it lasts, Ctrl-Z and a second signal leave the user's terminal as it was before.
  Terminal();
  ~Terminal();
  Terminal(const Terminal&) = delete;
  Terminal& operator=(const Terminal&) = delete;

  /// Shows these lines and nothing else, cut to the width of the screen. Of more lines than it has rows the first are
  /// shown, and the last. Every place is written once, so nothing flickers.
  void draw(const std::vector<std::string>& lines) const;
  /// Returns the pressed key, or 0, without waiting.
  [[nodiscard]] char key() const;

 private:
  bool keys_ = false;  // Standard input is a terminal as well.
};

/// A line that takes at most so many places, at least one; "…" stands for what was cut off. Sequences for colours
/// take no place, letters of East Asia two.
[[nodiscard]] std::string cut_to(const std::string& line, int columns);

}  // namespace triskin::cli
