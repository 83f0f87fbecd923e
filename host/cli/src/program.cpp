// SPDX-License-Identifier: GPL-3.0-or-later
#include "triskin/cli/program.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <filesystem>
#include <memory>
#include <new>

#include "did_you_mean.hpp"
#include "triskin/base/error.hpp"
#include "triskin/base/interrupt.hpp"

namespace triskin::cli {
namespace {

struct Entry {
  CLI::App* app = nullptr;
  Run run;
  bool json = false;
};

int fail(const std::string& what, int status) {
  std::fputs(fmt::format("triskin: {}\n", what).c_str(), stderr);
  return status;
}

// The file of -o; empty where the command has none or none was given.
std::string output_of(const CLI::App& app) {
  const CLI::Option* option = app.get_option_no_throw("--output");
  return option == nullptr || option->empty() ? std::string{} : option->as<std::string>();
}

// A command that wrote over what it reads would destroy it when it is interrupted, and could not be repeated.
void require_other_than_inputs(const CLI::App& app, const std::string& output) {
  std::error_code none;
  for (const CLI::Option* option : app.get_options()) {
    if (!option->get_positional()) continue;
    for (const std::string& input : option->results()) {
      if (std::filesystem::is_regular_file(input, none) && std::filesystem::equivalent(input, output, none))
        throw InputError(fmt::format("{}: is the input {}; give -o another file", output, input));
    }
  }
}

// A command that a signal ended says so in its status as a shell does: 128 and the number of the signal.
int unless_ended(int status) {
  constexpr int kSignalled = 128;
  return interrupt_signal() > 0 ? kSignalled + interrupt_signal() : status;
}

// Runs one command and turns what it throws into its exit status.
int run_entry(const Entry& entry) {
  try {
    const std::string file = output_of(*entry.app);
    if (file == "-" && entry.json) throw InputError("-o - and --json both want standard output; leave one out");
    require_other_than_inputs(*entry.app, file);
    Output output(entry.json, file == "-");
    const int status = entry.run(output);
    if (entry.json) std::fputs((output.result.dump() + "\n").c_str(), stdout);
    if (std::fflush(stdout) != 0 || std::ferror(stdout) != 0)
      return fail("standard output: cannot write; check the disk or the pipe", 2);
    return unless_ended(status);
  } catch (const Error& e) {
    return unless_ended(fail(e.what(), e.exit_status()));
  } catch (const std::bad_alloc&) {
    return fail("out of memory; use a smaller input", 2);
  } catch (const std::exception& e) {
    return fail(fmt::format("internal error: {}; please report it with the input", e.what()), 2);
  }
}

std::vector<std::unique_ptr<Entry>> add_commands(CLI::App& program) {
  std::vector<Command> commands = Registration::all();
  std::ranges::sort(commands, {}, &Command::name);
  std::vector<std::unique_ptr<Entry>> entries;
  for (const Command& command : commands) {
    auto entry = std::make_unique<Entry>();
    entry->app = program.add_subcommand(command.name, command.summary);
    entry->app->footer("Example:\n  " + command.example);
    entry->app->add_flag("--json", entry->json, "one JSON object on standard output; messages on standard error");
    entry->run = command.set_up(*entry->app);
    entries.push_back(std::move(entry));
  }
  return entries;
}

}  // namespace

int run_program(const std::string& description, int argc, char** argv) {
  CLI::App program{description};
  program.set_version_flag("--version", TRISKIN_VERSION);
  program.require_subcommand(1);
  program.footer("Each command has --help with an example.");
  const auto entries = add_commands(program);
  try {
    program.parse(argc, argv);
  } catch (const CLI::ParseError& e) {
    if (program.exit(e) == 0) return EXIT_SUCCESS;
    if (const std::string question = did_you_mean(program, argc, argv); !question.empty())
      std::fputs((question + "\n").c_str(), stderr);
    return 2;
  }
  for (const auto& entry : entries) {
    if (entry->app->parsed()) return run_entry(*entry);
  }
  return 2;
}

}  // namespace triskin::cli
