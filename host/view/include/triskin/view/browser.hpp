// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <filesystem>
#include <string>

namespace triskin::view {

/// Opens the page in the user's browser (xdg-open). The address holds the token, and the command line of a process can
/// be read by every user of the computer; so the browser gets the name of a file that leads it there, which only this
/// user can read ($XDG_RUNTIME_DIR, else state_home(), mode 0600). The browser has a session of its own and none of our
/// files or sockets: Ctrl-C does not reach it, and it does not hold the port.
class BrowserStart {
 public:
  /// Starts the browser with the page `address`. One that cannot be started is no error: the address was printed.
  explicit BrowserStart(const std::string& address);
  /// Removes the file; a browser that is open stays.
  ~BrowserStart();
  BrowserStart(const BrowserStart&) = delete;
  BrowserStart& operator=(const BrowserStart&) = delete;

  /// The file; empty: it could not be written, and no browser was started.
  [[nodiscard]] const std::filesystem::path& file() const { return file_; }

 private:
  std::filesystem::path file_;
};

}  // namespace triskin::view
