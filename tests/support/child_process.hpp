// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <signal.h>
#include <sys/types.h>

#include <cstdio>
#include <cstdlib>
#include <string>

#include "support/places.hpp"

namespace triskin::test {

/// Runs a program beside the test. Reading waits for its output.
class Child {
 public:
  /// `line` is a program and its arguments, as the shell reads them. The kernel ends it when the test dies; otherwise
  /// CTest would wait for it, because it holds the test's output open.
  explicit Child(const std::string& line)
      : pipe_(::popen(("echo $$; exec setpriv --pdeathsig KILL -- " + line).c_str(), "r")) {
    pid_ = static_cast<pid_t>(std::strtol(read_line().c_str(), nullptr, 10));
  }
  ~Child() { (void)end(); }
  Child(const Child&) = delete;
  Child& operator=(const Child&) = delete;

  std::string read_line() {
    std::string line;
    for (int c = std::fgetc(pipe_); c != EOF && c != '\n'; c = std::fgetc(pipe_)) line += static_cast<char>(c);
    return line;
  }
  /// Returns its remaining output, up to its end.
  std::string read_all() {
    std::string text;
    for (int c = std::fgetc(pipe_); c != EOF; c = std::fgetc(pipe_)) text += static_cast<char>(c);
    return text;
  }
  /// Sends Ctrl-C unless it has already ended.
  int end() {
    if (pipe_ == nullptr) return 0;
    if (pid_ > 1) (void)::kill(pid_, SIGINT);
    const int status = ::pclose(pipe_);
    pipe_ = nullptr;
    return status;
  }

 private:
  std::FILE* pipe_;
  pid_t pid_ = 0;
};

/// Runs `triskin simulate SCENE` in real time.
class ServedSimulation {
 public:
  explicit ServedSimulation(const std::string& scene)
      : child_("'" + program_file() + "' simulate '" + scene + "' --listen 127.0.0.1:0") {
    const std::string line = child_.read_line();
    const std::size_t at = line.find("127.0.0.1:");
    if (at != std::string::npos) link_ = "sim:" + line.substr(at, line.find_first_not_of("0123456789", at + 10) - at);
  }
  [[nodiscard]] const std::string& link() const { return link_; }

 private:
  Child child_;
  std::string link_;
};

}  // namespace triskin::test
