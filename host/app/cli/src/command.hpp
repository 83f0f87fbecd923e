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

/// A command prints its result as one JSON object with --json, otherwise as text. Messages go to standard error.
class Output {
 public:
  /// `json` says that the command was given --json. With `messages_aside`, messages go to standard error because
  /// standard output is used for something else: the JSON object, or the file of `-o -`.
  explicit Output(bool json, bool messages_aside = false) : json_(json), messages_aside_(json || messages_aside) {}

  /// The command fills this object, and --json prints it once, after the command has ended.
  nlohmann::json result = nlohmann::json::object();

  /// Returns true with --json, when only the object may go to standard output.
  [[nodiscard]] bool json() const { return json_; }
  /// Says once that all output comes from the simulation `link` instead of hardware. From then on every object of
  /// --json has "simulated": true.
  void mark_simulated();
  /// Marks the output as simulated without a message, for a command that has said it already.
  void mark_quietly_simulated() { simulated_ = true; }
  /// Suppresses messages and progress from now on; the object of --json stays.
  void silence() { is_silent_ = true; }
  /// Declares Ctrl-C the usual end of the command, so that its status remains what the command returns.
  void expect_interrupt() { expects_interrupt_ = true; }
  [[nodiscard]] bool expects_interrupt() const { return expects_interrupt_; }
  [[nodiscard]] bool simulated() const { return simulated_; }
  /// Prints one object on its own line immediately (--json), for commands that report while they run.
  void each(const nlohmann::json& object) const;
  /// Prints one line for a person to standard output, or to standard error if the other is in use.
  void say(const std::string& line) const;
  /// Shows a bar on a terminal after one second; elsewhere it prints one line per stage. Safe to call from any thread.
  [[nodiscard]] ProgressSink progress() const;

 private:
  bool json_, messages_aside_;
  bool simulated_ = false;
  bool expects_interrupt_ = false;
  bool is_silent_ = false;
};

/// Formats an object as one line of JSON. Bytes that are not UTF-8, as in a file name, become U+FFFD.
[[nodiscard]] std::string json_line(const nlohmann::json& object);

/// Prints one line "triskin: TEXT" on standard error, for a person.
void say_aside(const std::string& text);

/// Makes a validator for an option whose values are the names in `values`, in any case. --help lists the names, not the
/// numbers behind them.
template <class Value>
[[nodiscard]] CLI::Validator one_of(const std::map<std::string, Value>& values) {
  std::string names;
  for (const auto& [name, value] : values) names += (names.empty() ? "" : "|") + name;
  CLI::CheckedTransformer transformer(values, CLI::ignore_case);
  transformer.description("{" + names + "}");
  return transformer;
}

/// Runs a command and returns its exit status: 0 means success, 1 success with a bad answer. Throws triskin::Error for
/// 2 and 3.
using Run = std::function<int(Output&)>;

/// Commands are grouped by purpose, and --help lists the groups in this order.
enum class Group { kDesign, kHardware, kData, kDevelopment };

/// For each subcommand, `set_up` adds options to `app` and returns the function that runs with them. Options live in
/// the returned closure (a shared_ptr to a struct), because CLI11 keeps references.
struct Command {
  std::string name;
  std::string summary;
  std::string example;  ///< --help ends with this example.
  std::function<Run(CLI::App& app)> set_up;
  Group group = Group::kDevelopment;
};

/// Each command's file has one constant of this type at namespace scope, and main finds all of them.
class Registration {
 public:
  /// Adds the command to all(). This runs before main.
  explicit Registration(Command command);
  /// Returns all registered commands in arbitrary order.
  [[nodiscard]] static const std::vector<Command>& all();
};

}  // namespace triskin::cli
