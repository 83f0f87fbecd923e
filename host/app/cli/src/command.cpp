// SPDX-License-Identifier: GPL-3.0-or-later
#include "command.hpp"

#include <fmt/format.h>

#include <cstdio>

#include "progress_bar.hpp"
#include "triskin/base/terminal_text.hpp"

namespace triskin::cli {
namespace {

std::vector<Command>& registry() {
  static std::vector<Command> commands;
  return commands;
}

}  // namespace

std::string json_line(const nlohmann::json& object) {
  return object.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace) + "\n";
}

void say_aside(const std::string& text) {
  clear_progress_bar();
  std::fputs(("triskin: " + for_terminal(text) + "\n").c_str(), stderr);
}

void Output::each(const nlohmann::json& object) const {
  if (!json_) return;
  clear_progress_bar();
  nlohmann::json line = object;
  if (simulated_) line["simulated"] = true;
  std::fputs(json_line(line).c_str(), stdout);
  std::fflush(stdout);
}

void Output::mark_simulated() {
  if (!simulated_) say("Simulated; no hardware is involved.");
  simulated_ = true;
}

void Output::say(const std::string& line) const {
  if (is_silent_) return;
  clear_progress_bar();
  std::FILE* out = messages_aside_ ? stderr : stdout;
  std::fputs((for_terminal(line) + "\n").c_str(), out);
  std::fflush(out);
}

ProgressSink Output::progress() const {
  if (is_silent_) return {};
  return progress_on_standard_error();
}

Registration::Registration(Command command) {
  registry().push_back(std::move(command));
}

const std::vector<Command>& Registration::all() {
  return registry();
}

}  // namespace triskin::cli
