// SPDX-License-Identifier: GPL-3.0-or-later
#include "triskin/cli/command.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <memory>
#include <mutex>

namespace triskin::cli {
namespace {

std::vector<Command>& registry() {
  static std::vector<Command> commands;
  return commands;
}

using Clock = std::chrono::steady_clock;

// Draws one bar on standard error; quiet for the first second, so that short work leaves no trace.
class Bar {
 public:
  Bar() : terminal_(::isatty(STDERR_FILENO) != 0) {}
  Bar(const Bar&) = delete;
  Bar& operator=(const Bar&) = delete;
  ~Bar() {
    if (drawn_) std::fputs("\r\033[K", stderr);
  }

  void show(const Progress& p) {
    const std::lock_guard lock(mutex_);
    const auto now = Clock::now();
    if (now - start_ < std::chrono::seconds(1)) return;
    if (!terminal_) {
      if (p.stage != stage_) std::fputs(fmt::format("… {} {}\n", p.stage, p.detail).c_str(), stderr);
    } else if (p.stage != stage_ || now - last_ > std::chrono::milliseconds(100)) {
      draw(p);
      last_ = now;
    }
    stage_ = p.stage;
  }

 private:
  void draw(const Progress& p) {
    constexpr int kWidth = 30;
    std::string bar(kWidth, '.');
    if (p.fraction >= 0.0) std::fill_n(bar.begin(), static_cast<int>(kWidth * std::min(1.0, p.fraction)), '#');
    std::fputs(fmt::format("\r\033[K[{}] {} {}", bar, p.stage, p.detail).c_str(), stderr);
    std::fflush(stderr);
    drawn_ = true;
  }

  const bool terminal_;
  const Clock::time_point start_ = Clock::now();
  Clock::time_point last_;
  std::mutex mutex_;
  std::string stage_;
  bool drawn_ = false;
};

}  // namespace

void Output::say(const std::string& line) const {
  std::FILE* out = json_ ? stderr : stdout;
  std::fputs((line + "\n").c_str(), out);
  std::fflush(out);
}

ProgressSink Output::progress() const {
  auto bar = std::make_shared<Bar>();
  return [bar](const Progress& p) { bar->show(p); };
}

Registration::Registration(Command command) { registry().push_back(std::move(command)); }

const std::vector<Command>& Registration::all() { return registry(); }

}  // namespace triskin::cli
