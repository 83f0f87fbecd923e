// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <poll.h>
#include <pty.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdlib>
#include <string>
#include <string_view>
#include <vector>

namespace triskin::test {

/// Runs a program on its own terminal of a given size; with 0 columns and rows the terminal reports no size.
class TerminalProgram {
 public:
  TerminalProgram(const std::string& line, int columns, int rows) {
    const winsize size{static_cast<unsigned short>(rows), static_cast<unsigned short>(columns), 0, 0};
    pid_ = ::forkpty(&terminal_, nullptr, nullptr, &size);
    if (pid_ == 0) {
      (void)::prctl(PR_SET_PDEATHSIG, SIGKILL);
      ::execl("/bin/sh", "sh", "-c", line.c_str(), static_cast<char*>(nullptr));
      std::_Exit(127);
    }
  }
  ~TerminalProgram() {
    if (!ended_) (void)::kill(pid_, SIGKILL);
    (void)status();
    ::close(terminal_);
  }
  TerminalProgram(const TerminalProgram&) = delete;
  TerminalProgram& operator=(const TerminalProgram&) = delete;

  /// Returns the output so far once it contains `sign`, the program has ended, or half a minute has passed.
  const std::string& read_until(std::string_view sign) {
    for (int k = 0; k < 3000 && text_.find(sign) == std::string::npos; ++k) {
      pollfd p{terminal_, POLLIN, 0};
      if (::poll(&p, 1, 10) <= 0) continue;
      char bytes[4096];
      const ssize_t n = ::read(terminal_, bytes, sizeof bytes);
      if (n <= 0) break;
      text_.append(bytes, static_cast<std::size_t>(n));
    }
    return text_;
  }
  /// Returns all output until the program ends, for at most half a minute.
  const std::string& read_all() { return read_until("\x01 never written"); }
  void signal(int number) const { (void)::kill(pid_, number); }
  /// Sends a key as if somebody pressed it.
  void type(char key) const { (void)!::write(terminal_, &key, 1); }
  /// Waits until Ctrl-Z stops the program; returns false if the program ended instead.
  bool is_stopped() {
    int status = 0;
    ended_ = ::waitpid(pid_, &status, WUNTRACED) != pid_ || !WIFSTOPPED(status);
    return !ended_;
  }
  int status() {
    int status = 0;
    if (!ended_) ::waitpid(pid_, &status, 0);
    ended_ = true;
    return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
  }

 private:
  int terminal_ = -1;
  pid_t pid_ = 0;
  bool ended_ = false;
  std::string text_;
};

/// Emulates the screen of a VT100 terminal, with the sequences that programs use to move and to erase.
class Screen {
 public:
  Screen(std::size_t columns, std::size_t rows) : columns_(columns), lines_(rows, std::string(columns, ' ')) {}

  void write(std::string_view bytes) {
    for (std::size_t at = 0; at < bytes.size();) at += take(bytes.substr(at));
  }
  /// Returns the lines without trailing spaces.
  [[nodiscard]] std::vector<std::string> lines() const {
    std::vector<std::string> trimmed;
    for (const std::string& line : lines_) trimmed.push_back(line.substr(0, line.find_last_not_of(' ') + 1));
    return trimmed;
  }
  [[nodiscard]] int wraps() const { return wraps_; }
  [[nodiscard]] int scrolls() const { return scrolls_; }

 private:
  // Returns the number of bytes consumed.
  std::size_t take(std::string_view rest) {
    const char c = rest.front();
    if (c == '\r') return column_ = 0, 1;
    if (c == '\n') return line_feed(), 1;
    if (rest.starts_with("\033[")) return sequence(rest);
    if ((c & 0xC0) == 0x80 || static_cast<unsigned char>(c) < 0x20) return 1;  // Only a letter's first byte counts.
    // The characters U+3000 to U+9FFF (mostly Chinese and Japanese) begin with these bytes and take two columns.
    const bool is_wide = static_cast<unsigned char>(c) >= 0xE3 && static_cast<unsigned char>(c) <= 0xE9;
    if (column_ + (is_wide ? 1 : 0) >= columns_) {
      ++wraps_;
      column_ = 0;
      line_feed();
    }
    lines_[row_][column_++] = (c & 0x80) == 0 ? c : '~';
    if (is_wide && column_ < columns_) lines_[row_][column_++] = '~';
    return 1;
  }
  void line_feed() {
    if (++row_ < lines_.size()) return;
    --row_;
    ++scrolls_;
    lines_.erase(lines_.begin());
    lines_.emplace_back(columns_, ' ');
  }
  std::size_t sequence(std::string_view rest) {
    const std::size_t end = rest.find_first_not_of("0123456789;?", 2);
    if (end == std::string_view::npos) return rest.size();
    const std::size_t count = std::strtoul(std::string(rest.substr(2, end - 2)).c_str(), nullptr, 10);
    const std::size_t from = std::min(column_, columns_ - 1);
    if (rest[end] == 'A') row_ -= std::min(row_, count);
    if (rest[end] == 'H') row_ = column_ = 0;
    if (rest[end] == 'K' || rest[end] == 'J') lines_[row_].replace(from, columns_ - from, columns_ - from, ' ');
    for (std::size_t below = row_ + 1; rest[end] == 'J' && below < lines_.size(); ++below)
      lines_[below].assign(columns_, ' ');
    return end + 1;
  }

  std::size_t columns_, row_ = 0, column_ = 0;
  std::vector<std::string> lines_;
  int wraps_ = 0, scrolls_ = 0;
};

}  // namespace triskin::test
