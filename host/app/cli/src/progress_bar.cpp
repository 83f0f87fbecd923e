// SPDX-License-Identifier: GPL-3.0-or-later
#include "progress_bar.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <map>
#include <memory>
#include <mutex>
#include <string>

#include "terminal.hpp"
#include "triskin/base/terminal_text.hpp"

namespace triskin::cli {
namespace {

using Clock = std::chrono::steady_clock;

// Part of the work as it is shown: when its stage began, and with which fraction.
struct Shown {
  Progress progress{};
  Clock::time_point since = Clock::now();
  double from = 0.0;

  void take(const Progress& p) {
    if (p.stage != progress.stage) {
      since = Clock::now();
      from = std::max(0.0, p.fraction);
    }
    progress = p;
  }
  // Says how long the stage will still take if it goes on as fast as so far; empty while that is not known.
  [[nodiscard]] std::string time_left() const {
    constexpr double kMinFraction = 0.02, kMinTime_s = 1.0, kMinute_s = 60.0;
    const double done = progress.fraction - from;
    const double passed_s = std::chrono::duration<double>(Clock::now() - since).count();
    if (done < kMinFraction || passed_s < kMinTime_s || progress.fraction >= 1.0) return {};
    const double left_s = passed_s * (1.0 - progress.fraction) / done;
    return left_s < 2.0 * kMinute_s ? fmt::format(" {:.0f} s left,", left_s)
                                    : fmt::format(" {:.0f} min left,", left_s / kMinute_s);
  }
};

std::string bar_line(const Shown& shown, int columns) {
  const Progress& p = shown.progress;
  constexpr int kWidth = 30, kNarrowWidth = 8, kNarrowTerminal = 60;
  const int width = columns < kNarrowTerminal ? kNarrowWidth : kWidth;
  std::string bar(static_cast<std::size_t>(width), '.');
  if (p.fraction >= 0.0) std::fill_n(bar.begin(), static_cast<int>(width * std::min(1.0, p.fraction)), '#');
  // The last column stays free because some terminals wrap as soon as it is written.
  return cut_to(fmt::format("[{}]{} {} {}", bar, shown.time_left(), p.stage, for_terminal(p.detail)), columns - 1);
}

class Bar {
 public:
  Bar() : terminal_(::isatty(STDERR_FILENO) != 0 && !Terminal::is_dumb()) {}
  Bar(const Bar&) = delete;
  Bar& operator=(const Bar&) = delete;
  ~Bar() {
    const std::lock_guard lock(mutex);
    clear();
    if (drawn == this) drawn = nullptr;
  }

  void show(const Progress& p) {
    const std::lock_guard lock(mutex);
    const auto now = Clock::now();
    Shown& part = parts_[p.part];
    const bool new_stage = p.stage != part.progress.stage;
    part.take(p);
    if (now - start_ < std::chrono::seconds(1)) return;
    if (!terminal_) {
      if (new_stage) std::fputs(fmt::format("… {} {}\n", p.stage, for_terminal(p.detail)).c_str(), stderr);
    } else if (new_stage || now - last_ > std::chrono::milliseconds(100)) {
      draw();
      last_ = now;
    }
  }
  static void clear_drawn() {
    const std::lock_guard lock(mutex);
    if (drawn != nullptr) drawn->clear();
  }

 private:
  // Moves the cursor to the first line and clears all lines.
  [[nodiscard]] std::string back() const {
    return lines_ > 1 ? fmt::format("\r\033[{}A\033[J", lines_ - 1) : "\r\033[J";
  }
  void clear() {
    if (lines_ > 0) std::fputs(back().c_str(), stderr);
    lines_ = 0;
  }
  // If there are many parts, the finished ones make room for others.
  void draw() {
    constexpr int kMaxLines = 20;
    const Terminal::Size size = Terminal::size(STDERR_FILENO);
    const int room = std::clamp(size.rows - 1, 1, kMaxLines);
    const int parts = static_cast<int>(parts_.size() - parts_.count(-1));
    std::string text = lines_ > 0 ? back() : "\r";
    int lines = 0;
    for (const auto& [part, shown] : parts_) {
      const bool is_drawn = part < 0 ? parts == 0 : lines < room && (parts <= room || shown.progress.fraction < 1.0);
      if (!is_drawn) continue;
      if (lines++ > 0) text += '\n';
      text += bar_line(shown, size.columns);
    }
    std::fputs(text.c_str(), stderr);
    std::fflush(stderr);
    lines_ = lines;
    drawn = this;
  }

  static std::mutex mutex;
  static Bar* drawn;
  const bool terminal_;
  const Clock::time_point start_ = Clock::now();
  Clock::time_point last_;
  std::map<int, Shown> parts_;
  int lines_ = 0;
};

std::mutex Bar::mutex;
Bar* Bar::drawn = nullptr;

}  // namespace

ProgressSink progress_on_standard_error() {
  auto bar = std::make_shared<Bar>();
  return [bar](const Progress& p) { bar->show(p); };
}

void clear_progress_bar() {
  Bar::clear_drawn();
}

}  // namespace triskin::cli
