// SPDX-License-Identifier: GPL-3.0-or-later
#include "terminal.hpp"

#include <poll.h>
#include <signal.h>
#include <sys/ioctl.h>
#include <termios.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <cstdlib>
#include <string_view>
#include <utility>

#include "triskin/base/interrupt.hpp"
#include "triskin/base/terminal_text.hpp"

namespace triskin::cli {
namespace {

// Signal handlers read this state: the modes before the first Terminal, and whether input arrives key by key.
termios modes_before{};
volatile sig_atomic_t takes_keys = 0;

// Signal handlers call both functions, so these use system calls only.
void enter_page() {
  termios single = modes_before;
  single.c_lflag &= ~static_cast<tcflag_t>(ICANON | ECHO);
  single.c_cc[VMIN] = 0;
  single.c_cc[VTIME] = 0;
  if (takes_keys != 0) (void)::tcsetattr(STDIN_FILENO, TCSANOW, &single);
  constexpr std::string_view kOtherPageWithoutCursor = "\033[?1049h\033[?25l";
  (void)!::write(STDOUT_FILENO, kOtherPageWithoutCursor.data(), kOtherPageWithoutCursor.size());
}
void leave_page() {
  constexpr std::string_view kCursorAndFirstPage = "\033[?25h\033[?1049l";
  (void)!::write(STDOUT_FILENO, kCursorAndFirstPage.data(), kCursorAndFirstPage.size());
  if (takes_keys != 0) (void)::tcsetattr(STDIN_FILENO, TCSANOW, &modes_before);
}

// On Ctrl-Z the shell gets its terminal back; the page returns when the process continues.
void stop_here(int /*signal*/) {
  leave_page();
  (void)::raise(SIGSTOP);
  enter_page();
}

void put(const std::string& text) {
  std::fwrite(text.data(), 1, text.size(), stdout);
  std::fflush(stdout);
}

// Returns the length in bytes of the colour sequence that begins at `at`, or 0 if there is none.
std::size_t colour_bytes(std::string_view text, std::size_t at) {
  if (!text.substr(at).starts_with("\033[")) return 0;
  const std::size_t end = text.find('m', at);
  return end == std::string_view::npos ? 0 : end + 1 - at;
}

// Returns the columns that a character takes: wide East Asian characters and pictographs take two, combining marks none
// (Unicode Standard Annex 11, in blocks).
int places_of(char32_t c) {
  constexpr auto kWide = std::to_array<std::pair<char32_t, char32_t>>({{0x1100, 0x115F},
                                                                       {0x2E80, 0xA4CF},
                                                                       {0xAC00, 0xD7A3},
                                                                       {0xF900, 0xFAFF},
                                                                       {0xFE30, 0xFE6F},
                                                                       {0xFF00, 0xFF60},
                                                                       {0xFFE0, 0xFFE6},
                                                                       {0x1F300, 0x1FAFF},
                                                                       {0x20000, 0x3FFFD}});
  constexpr std::pair<char32_t, char32_t> kJoining{0x0300, 0x036F};
  if (c >= kJoining.first && c <= kJoining.second) return 0;
  return std::ranges::any_of(kWide, [c](const auto& block) { return c >= block.first && c <= block.second; }) ? 2 : 1;
}

// Each character knows where it begins and how many columns the line has taken up to its end.
struct Character {
  std::size_t at = 0;
  int places = 0;
};
std::vector<Character> characters_of(const std::string& line) {
  std::vector<Character> characters;
  int places = 0;
  for (std::size_t at = 0; at < line.size();) {
    const std::size_t colour = colour_bytes(line, at);
    const Utf8Character c = utf8_at(line, at);
    if (colour == 0) characters.push_back({at, places += places_of(c.code)});
    at += colour > 0 ? colour : std::max<std::size_t>(1, c.bytes);
  }
  return characters;
}
int places_of(const std::vector<Character>& characters) {
  return characters.empty() ? 0 : characters.back().places;
}

}  // namespace

std::string cut_to(const std::string& line, int columns) {
  const std::vector<Character> characters = characters_of(line);
  if (places_of(characters) <= columns) return line;
  const bool has_colours = line.find("\033[") != std::string::npos;
  const auto first = std::ranges::find_if(characters, [&](const Character& c) { return c.places >= columns; });
  return line.substr(0, first->at) + "…" + (has_colours ? "\033[0m" : "");
}

bool Terminal::is_dumb() {
  const char* term = std::getenv("TERM");
  return term == nullptr || *term == '\0' || std::string_view(term) == "dumb";
}

bool Terminal::has_colour() {
  const char* no_colour = std::getenv("NO_COLOR");
  return no_colour == nullptr || *no_colour == '\0';
}

bool Terminal::there() {
  return ::isatty(STDOUT_FILENO) != 0 && !is_dumb();
}

Terminal::Size Terminal::size(int descriptor) {
  winsize window{};
  if (::ioctl(descriptor, TIOCGWINSZ, &window) != 0 || window.ws_col == 0 || window.ws_row == 0) return {};
  return {window.ws_col, window.ws_row};
}

Terminal::Terminal() : keys_(::isatty(STDIN_FILENO) != 0 && ::tcgetattr(STDIN_FILENO, &modes_before) == 0) {
  takes_keys = keys_ ? 1 : 0;
  enter_page();
  before_sudden_end(&leave_page);
  struct sigaction action{};
  action.sa_handler = &stop_here;
  action.sa_flags = SA_RESTART;
  (void)::sigaction(SIGTSTP, &action, nullptr);
}

Terminal::~Terminal() {
  (void)::signal(SIGTSTP, SIG_DFL);
  before_sudden_end(nullptr);
  leave_page();
}

void Terminal::draw(const std::vector<std::string>& lines) const {
  const Size screen = size();
  const std::size_t rows = std::min(lines.size(), static_cast<std::size_t>(screen.rows));
  std::string page = "\033[H";
  for (std::size_t row = 0; row < rows; ++row) {
    const std::string& line = row + 1 < rows ? lines[row] : lines.back();
    page += (row > 0 ? "\r\n" : "") + cut_to(line, screen.columns);
    // After a full line the cursor is still in the last column, so erasing would delete that column.
    if (places_of(characters_of(line)) < screen.columns) page += "\033[K";
  }
  if (rows < static_cast<std::size_t>(screen.rows)) page += "\r\n\033[J";
  put(page);
}

char Terminal::key() const {
  if (!keys_) return 0;
  pollfd input{STDIN_FILENO, POLLIN, 0};
  char c = 0;
  return ::poll(&input, 1, 0) > 0 && ::read(STDIN_FILENO, &c, 1) == 1 ? c : '\0';
}

}  // namespace triskin::cli
