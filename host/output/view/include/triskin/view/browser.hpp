// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <filesystem>
#include <string>

namespace triskin::view {

/// Opens the page in the user's browser (xdg-open). The address contains the token, and every user of the computer can
/// read the command line of a process. The browser therefore gets the name of a file that redirects to the address and
/// that only this user can read ($XDG_RUNTIME_DIR, else state_home(), mode 0600). The browser runs in its own session
/// without our files and sockets, so Ctrl-C does not reach it and it does not keep the port open.
class BrowserStart {
 public:
  /// Starts the browser with the page `address`. A failure to start is no error, because the address was printed.
  explicit BrowserStart(const std::string& address);
  /// Removes the file; an open browser stays open.
  ~BrowserStart();
  BrowserStart(const BrowserStart&) = delete;
  BrowserStart& operator=(const BrowserStart&) = delete;

  /// Returns the file; empty if it could not be written, and then no browser was started.
  [[nodiscard]] const std::filesystem::path& file() const { return file_; }

 private:
  std::filesystem::path file_;
};

}  // namespace triskin::view
