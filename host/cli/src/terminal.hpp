// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <termios.h>

#include <string>
#include <vector>

namespace triskin::cli {

/// A terminal that shows pages and takes single keys. What was on it before is there again afterwards.
class Terminal {
 public:
  /// True when standard output is a terminal that can move its cursor.
  [[nodiscard]] static bool there();
  /// TERM says that the terminal cannot move its cursor.
  [[nodiscard]] static bool is_dumb();
  /// Size of the screen in characters.
  struct Size {
    int columns = 80, rows = 24;  ///< what terminals have that do not tell
  };
  [[nodiscard]] static Size size();
  Terminal();
  ~Terminal();
  Terminal(const Terminal&) = delete;
  Terminal& operator=(const Terminal&) = delete;

  /// Shows these lines and nothing else. Every place is written once, so nothing flickers.
  void draw(const std::vector<std::string>& lines) const;
  /// A key that was pressed; 0: none. Does not wait.
  [[nodiscard]] char key() const;

 private:
  bool keys_ = false;  // Standard input is a terminal as well.
  termios before_{};
};

}  // namespace triskin::cli
