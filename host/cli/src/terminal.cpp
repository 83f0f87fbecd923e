// SPDX-License-Identifier: GPL-3.0-or-later
#include "terminal.hpp"

#include <poll.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <cstdio>
#include <cstdlib>
#include <string_view>

namespace triskin::cli {
namespace {

void put(const std::string& text) {
  std::fwrite(text.data(), 1, text.size(), stdout);
  std::fflush(stdout);
}

}  // namespace

bool Terminal::is_dumb() {
  const char* term = std::getenv("TERM");
  return term != nullptr && std::string_view(term) == "dumb";
}

bool Terminal::there() {
  return ::isatty(STDOUT_FILENO) != 0 && !is_dumb();
}

Terminal::Size Terminal::size() {
  winsize window{};
  if (::ioctl(STDOUT_FILENO, TIOCGWINSZ, &window) != 0 || window.ws_col == 0 || window.ws_row == 0) return {};
  return {window.ws_col, window.ws_row};
}

Terminal::Terminal() : keys_(::isatty(STDIN_FILENO) != 0 && ::tcgetattr(STDIN_FILENO, &before_) == 0) {
  if (keys_) {
    termios single = before_;
    single.c_lflag &= ~static_cast<tcflag_t>(ICANON | ECHO);
    single.c_cc[VMIN] = 0;
    single.c_cc[VTIME] = 0;
    (void)::tcsetattr(STDIN_FILENO, TCSANOW, &single);
  }
  put("\033[?1049h\033[?25l");  // The escape sequence switches to the alternate screen and hides the cursor.
}

Terminal::~Terminal() {
  put("\033[?25h\033[?1049l");
  if (keys_) (void)::tcsetattr(STDIN_FILENO, TCSANOW, &before_);
}

void Terminal::draw(const std::vector<std::string>& lines) const {
  std::string page = "\033[H";
  for (const std::string& line : lines) page += line + "\033[K\r\n";
  put(page + "\033[J");
}

char Terminal::key() const {
  if (!keys_) return 0;
  pollfd input{STDIN_FILENO, POLLIN, 0};
  char c = 0;
  return ::poll(&input, 1, 0) > 0 && ::read(STDIN_FILENO, &c, 1) == 1 ? c : '\0';
}

}  // namespace triskin::cli
