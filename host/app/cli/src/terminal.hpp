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
  /// Returns true if TERM names a terminal that cannot move its cursor, or if TERM is not set.
  [[nodiscard]] static bool is_dumb();
  /// Returns true unless the user disabled colours with NO_COLOR (https://no-color.org).
  [[nodiscard]] static bool has_colour();
  /// Size of the screen in characters.
  struct Size {
    int columns = 80, rows = 24;  ///< Terminals that do not report their size are assumed to have this one.
  };
  /// Returns the size of the terminal behind a file descriptor, by default standard output.
  [[nodiscard]] static Size size(int descriptor = 1);
  /// At most one Terminal may exist. While it does, Ctrl-Z and a second signal restore the user's terminal.
  Terminal();
  ~Terminal();
  Terminal(const Terminal&) = delete;
  Terminal& operator=(const Terminal&) = delete;

  /// Shows only these lines, cut to the width of the screen. If the screen has too few rows, the first lines and the
  /// last one are shown. Every place is written only once, which avoids flicker.
  void draw(const std::vector<std::string>& lines) const;
  /// Returns the pressed key, or 0, without waiting.
  [[nodiscard]] char key() const;

 private:
  bool keys_ = false;  // Standard input is a terminal as well.
};

/// Cuts a line to `columns` columns, at least one, and marks the cut with "…". Colour sequences take no column, East
/// Asian characters two.
[[nodiscard]] std::string cut_to(const std::string& line, int columns);

}  // namespace triskin::cli
