// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <termios.h>

#include <string>
#include <vector>

namespace triskin::cli {

/// A terminal shows pages and reads single keys. Its former contents are restored afterwards.
class Terminal {
 public:
  /// Returns true when standard output is a terminal that can move its cursor.
  [[nodiscard]] static bool there();
  /// Returns true if TERM says that the terminal cannot move its cursor.
  [[nodiscard]] static bool is_dumb();
  /// The size of the screen is in characters.
  struct Size {
    int columns = 80, rows = 24;  ///< Terminals that do not report their size are assumed to have this one.
  };
  [[nodiscard]] static Size size();
  Terminal();
  ~Terminal();
  Terminal(const Terminal&) = delete;
  Terminal& operator=(const Terminal&) = delete;

  /// Shows these lines and nothing else. Every place is written once, so nothing flickers.
  void draw(const std::vector<std::string>& lines) const;
  /// Returns the pressed key, or 0, without waiting.
  [[nodiscard]] char key() const;

 private:
  bool keys_ = false;  // True means that standard input is a terminal as well.
  termios before_{};
};

}  // namespace triskin::cli
