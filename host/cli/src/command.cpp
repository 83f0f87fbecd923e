// SPDX-License-Identifier: GPL-3.0-or-later
#include "triskin/cli/command.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <map>
#include <memory>
#include <mutex>
#include <string_view>

#include "triskin/base/terminal_text.hpp"

namespace triskin::cli {
namespace {

std::vector<Command>& registry() {
  static std::vector<Command> commands;
  return commands;
}

using Clock = std::chrono::steady_clock;

// Returns true if TERM says that the terminal cannot move back on a line.
bool is_dumb() {
  const char* term = std::getenv("TERM");
  return term != nullptr && std::string_view(term) == "dumb";
}

// Draws a bar on standard error, or one for each active part of the work. It shows nothing in the first second, so that
// short work leaves no trace.
class Bar {
 public:
  Bar() : terminal_(::isatty(STDERR_FILENO) != 0 && !is_dumb()) {}
  Bar(const Bar&) = delete;
  Bar& operator=(const Bar&) = delete;
  ~Bar() {
    if (lines_ > 0) std::fputs(back().c_str(), stderr);
  }

  void show(const Progress& p) {
    const std::lock_guard lock(mutex_);
    const auto now = Clock::now();
    Progress& part = parts_[p.part];
    const bool new_stage = p.stage != part.stage;
    part = p;
    if (now - start_ < std::chrono::seconds(1)) return;
    if (!terminal_) {
      if (new_stage) std::fputs(fmt::format("… {} {}\n", p.stage, for_terminal(p.detail)).c_str(), stderr);
    } else if (new_stage || now - last_ > std::chrono::milliseconds(100)) {
      draw();
      last_ = now;
    }
  }

 private:
  // Moves to the first line and clears all lines.
  [[nodiscard]] std::string back() const {
    return lines_ > 1 ? fmt::format("\r\033[{}A\033[J", lines_ - 1) : "\r\033[J";
  }
  static std::string line(const Progress& p) {
    constexpr int kWidth = 30;
    std::string bar(kWidth, '.');
    if (p.fraction >= 0.0) std::fill_n(bar.begin(), static_cast<int>(kWidth * std::min(1.0, p.fraction)), '#');
    return fmt::format("[{}] {} {}", bar, p.stage, for_terminal(p.detail));
  }
  // If there are many parts, finished ones make room for others.
  void draw() {
    constexpr std::size_t kLines = 20;
    const std::size_t parts = parts_.size() - parts_.count(-1);
    std::string text = back();
    int lines = 0;
    for (const auto& [part, p] : parts_) {
      const bool shown =
          part < 0 ? parts == 0 : parts <= kLines || (p.fraction < 1.0 && lines < static_cast<int>(kLines));
      if (!shown) continue;
      if (lines++ > 0) text += '\n';
      text += line(p);
    }
    std::fputs(text.c_str(), stderr);
    std::fflush(stderr);
    lines_ = lines;
  }

  const bool terminal_;
  const Clock::time_point start_ = Clock::now();
  Clock::time_point last_;
  std::mutex mutex_;
  std::map<int, Progress> parts_;
  int lines_ = 0;
};

}  // namespace

std::string json_line(const nlohmann::json& object) {
  return object.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace) + "\n";
}

void say_aside(const std::string& text) {
  std::fputs(("triskin: " + for_terminal(text) + "\n").c_str(), stderr);
}

void Output::each(const nlohmann::json& object) const {
  if (!json_) return;
  nlohmann::json line = object;
  if (simulated_) line["simulated"] = true;
  std::fputs(json_line(line).c_str(), stdout);
  std::fflush(stdout);
}

void Output::mark_simulated(const std::string& link) {
  if (!simulated_) say(fmt::format("simulated: {} is no hardware", link));
  simulated_ = true;
}

void Output::say(const std::string& line) const {
  if (is_silent_) return;
  std::FILE* out = messages_aside_ ? stderr : stdout;
  std::fputs((for_terminal(line) + "\n").c_str(), out);
  std::fflush(out);
}

ProgressSink Output::progress() const {
  if (is_silent_) return {};
  auto bar = std::make_shared<Bar>();
  return [bar](const Progress& p) { bar->show(p); };
}

Registration::Registration(Command command) {
  registry().push_back(std::move(command));
}

const std::vector<Command>& Registration::all() {
  return registry();
}

}  // namespace triskin::cli
