// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <fcntl.h>
#include <signal.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <atomic>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <functional>
#include <stdexcept>
#include <string>

#include "app/cli/shell_case.hpp"

namespace triskin::test {

/// Returns the library that shifts the clock and fills the disk of a program.
inline std::string fault_library() {
  return (std::filesystem::path(program_file()).parent_path() / "libtriskin_test_faults.so").string();
}

/// Waits at most half a minute for `done`; returns false if it did not become true.
inline bool wait_until(const std::function<bool()>& done) {
  for (int k = 0; k < 3000; ++k) {
    if (done()) return true;
    ::usleep(10'000);
  }
  return false;
}

/// Returns the environment for that library. The address sanitizer requires to be the first library, but it is not used
/// here.
inline std::string with_faults(const std::string& variables) {
  return "env ASAN_OPTIONS=verify_asan_link_order=0:detect_leaks=0 LD_PRELOAD='" + fault_library() + "' " + variables +
         " ";
}

/// Gives other programs a wall clock that the test sets.
class SteppedClock {
 public:
  explicit SteppedClock(const std::filesystem::path& file) : file_(file) {
    std::ofstream(file_, std::ios::binary) << std::string(sizeof(std::int64_t), '\0');
    const int fd = ::open(file_.c_str(), O_RDWR | O_CLOEXEC);
    void* memory = ::mmap(nullptr, sizeof(std::int64_t), PROT_READ | PROT_WRITE, MAP_SHARED, fd, 0);
    ::close(fd);
    if (memory == MAP_FAILED) throw std::runtime_error("mmap");
    shift_ = static_cast<std::atomic<std::int64_t>*>(memory);
  }
  ~SteppedClock() { ::munmap(shift_, sizeof *shift_); }
  SteppedClock(const SteppedClock&) = delete;
  SteppedClock& operator=(const SteppedClock&) = delete;

  /// Sets the clock `seconds` before (< 0) or after the true one.
  void shift(std::int64_t seconds) { *shift_ = seconds; }
  [[nodiscard]] std::string variables() const { return "TRISKIN_TEST_WALL='" + file_.string() + "'"; }

 private:
  std::filesystem::path file_;
  std::atomic<std::int64_t>* shift_ = nullptr;
};

/// Runs a program under the shell and waits for its end. It writes into the file `log`. The test does not kill it: the
/// kernel ends it when the test dies.
class Running {
 public:
  Running(const std::string& line, std::filesystem::path log) : log_(std::move(log)) {
    std::filesystem::remove(log_);
    pid_ = ::fork();
    if (pid_ == 0) {
      (void)::prctl(PR_SET_PDEATHSIG, SIGKILL);
      const std::string command = (line.starts_with("cd ") ? "" : "exec ") + line + " >'" + log_.string() + "' 2>&1";
      ::execl("/bin/sh", "sh", "-c", command.c_str(), static_cast<char*>(nullptr));
      std::_Exit(127);
    }
  }
  ~Running() {
    if (!ended_) (void)::kill(pid_, SIGKILL);
    (void)status();
  }
  Running(const Running&) = delete;
  Running& operator=(const Running&) = delete;

  void signal(int number) const { (void)::kill(pid_, number); }
  [[nodiscard]] pid_t pid() const { return pid_; }
  [[nodiscard]] std::string text() const { return std::filesystem::exists(log_) ? read_file(log_) : ""; }
  /// Waits until it has printed `sign`; returns false if it ended before, or half a minute passed.
  bool says(const std::string& sign) {
    const auto said = [&] { return text().find(sign) != std::string::npos; };
    (void)wait_until([&] { return said() || has_ended(); });
    return said();
  }
  /// Returns true when it ends within half a minute, which is far above what a loaded machine needs: a program that
  /// ignores signals would run forever.
  bool ends() {
    return wait_until([this] { return has_ended(); });
  }
  /// Waits for its end and returns the exit status in the way of a shell.
  int status() {
    if (!ended_) ::waitpid(pid_, &status_, 0);
    ended_ = true;
    return WIFEXITED(status_) ? WEXITSTATUS(status_) : 128 + WTERMSIG(status_);
  }

 private:
  bool has_ended() {
    if (!ended_) ended_ = ::waitpid(pid_, &status_, WNOHANG) == pid_;
    return ended_;
  }

  std::filesystem::path log_;
  pid_t pid_ = 0;
  int status_ = 0;
  bool ended_ = false;
};

}  // namespace triskin::test
