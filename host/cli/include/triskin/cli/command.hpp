// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <CLI/CLI.hpp>
#include <functional>
#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "triskin/base/progress.hpp"

namespace triskin::cli {

/// Result of a command: one JSON object with --json, else text. Messages go to standard error.
class Output {
 public:
  /// `json`: the command was given --json.
  /// `messages_aside`: messages go to standard error because standard output takes something else: the JSON object, or
  /// the file of `-o -`.
  explicit Output(bool json, bool messages_aside = false) : json_(json), messages_aside_(json || messages_aside) {}

  /// The object printed by --json. Filled by the command; printed once, when it has ended.
  nlohmann::json result = nlohmann::json::object();

  /// True with --json: only the object may go to standard output.
  [[nodiscard]] bool json() const { return json_; }
  /// Says once that all output comes from the simulation `link`, not from hardware. From then on every object of
  /// --json has "simulated": true.
  void mark_simulated(const std::string& link);
  /// The same for a command that has said it by itself.
  void mark_quietly_simulated() { simulated_ = true; }
  /// From now on messages and progress are left out; the object of --json stays.
  void silence() { is_silent_ = true; }
  /// Ctrl-C is the usual end of the command: its status stays what the command returns.
  void expect_interrupt() { expects_interrupt_ = true; }
  [[nodiscard]] bool expects_interrupt() const { return expects_interrupt_; }
  [[nodiscard]] bool simulated() const { return simulated_; }
  /// Prints one object on its own line at once (--json), for commands that answer while they run.
  void each(const nlohmann::json& object) const;
  /// One line for a person: standard output, or standard error where the other is taken.
  void say(const std::string& line) const;
  /// Bar on a terminal after one second; elsewhere one line per stage. Safe to call from any thread.
  [[nodiscard]] ProgressSink progress() const;

 private:
  bool json_, messages_aside_;
  bool simulated_ = false;
  bool expects_interrupt_ = false;
  bool is_silent_ = false;
};

/// An object as one line of JSON. Bytes that are no UTF-8, as a file name may have, become U+FFFD.
[[nodiscard]] std::string json_line(const nlohmann::json& object);

/// One line "triskin: TEXT" on standard error, for a person.
void say_aside(const std::string& text);

/// Validator of an option that takes one of the names of `values`, in any case. --help lists the names, not the numbers
/// behind them.
template <class Value>
[[nodiscard]] CLI::Validator one_of(const std::map<std::string, Value>& values) {
  std::string names;
  for (const auto& [name, value] : values) names += (names.empty() ? "" : "|") + name;
  CLI::CheckedTransformer transformer(values, CLI::ignore_case);
  transformer.description("{" + names + "}");
  return transformer;
}

/// Runs a command and returns its exit status: 0 done, 1 done and the answer is bad. Throws triskin::Error for 2 and 3.
using Run = std::function<int(Output&)>;

/// Purpose of a command; --help lists the commands of a group together, in this order.
enum class Group { kDesign, kHardware, kData, kDevelopment };

/// One subcommand. `set_up` adds options to `app` and returns what runs them; options live in the returned closure
/// (a shared_ptr to a struct), since CLI11 keeps references.
struct Command {
  std::string name;
  std::string summary;
  std::string example;  ///< --help shows it.
  std::function<Run(CLI::App& app)> set_up;
  Group group = Group::kDevelopment;
};

/// Each command's file holds one constant of this type at namespace scope; main finds all of them.
class Registration {
 public:
  /// Adds the command to all(). Runs before main.
  explicit Registration(Command command);
  /// All registered commands, in no order.
  [[nodiscard]] static const std::vector<Command>& all();
};

}  // namespace triskin::cli
