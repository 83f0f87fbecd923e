// SPDX-License-Identifier: GPL-3.0-or-later
#include "program.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cmath>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <filesystem>
#include <iostream>
#include <memory>
#include <new>
#include <string_view>
#include <system_error>
#include <utility>

#include "did_you_mean.hpp"
#include "error_words.hpp"
#include "generate_docs.hpp"
#include "help_command.hpp"
#include "help_format.hpp"
#include "ros_arguments.hpp"
#include "settings.hpp"
#include "triskin/base/error.hpp"
#include "triskin/base/interrupt.hpp"

namespace triskin::cli {
namespace {

struct Entry {
  CLI::App* app = nullptr;
  Run run;
  bool json = false;
};

// Cuts the middle out of what is longer than `max` bytes between two of `separators`, at the border of a character.
std::string shortened(std::string_view text, std::string_view separators, std::size_t max) {
  const auto border = [](std::string_view part, std::size_t at) {
    while (at > 0 && at < part.size() && (static_cast<unsigned char>(part[at]) & 0xC0) == 0x80) --at;
    return at;
  };
  std::string out;
  while (!text.empty()) {
    const std::string_view part = text.substr(0, text.find_first_of(separators));
    if (part.size() <= max)
      out += part;
    else
      out.append(part.substr(0, border(part, max / 2)))
          .append("…")
          .append(part.substr(border(part, part.size() - max / 4)));
    text.remove_prefix(part.size());
    if (text.empty()) break;
    out += text.front();
    text.remove_prefix(1);
  }
  return out;
}

// What a message repeats of a file or of the command line may be as long as the file.
int fail(const std::string& what, int status) {
  constexpr std::size_t kMaxWord_bytes = 400, kMaxLine_bytes = 2'000;
  say_aside(shortened(shortened(what, " \n", kMaxWord_bytes), "\n", kMaxLine_bytes));
  return status;
}

// Returns the file of -o, or an empty text if there is none.
std::string output_of(const CLI::App& app) {
  const CLI::Option* option = app.get_option_no_throw("--output");
  return option == nullptr || option->empty() ? std::string{} : option->as<std::string>();
}

bool is_nan(const std::string& text) {
  return std::isnan(std::strtod(text.c_str(), nullptr));
}

// An empty value is what an unset variable of a shell leaves; it would count as 0 or as if the option were left out.
void require_values(const CLI::App& app) {
  for (const CLI::Option* option : app.get_options()) {
    if (std::ranges::any_of(option->results(), &std::string::empty))
      throw InputError(fmt::format("{}: the value is empty", option->get_name()));
    // It is neither below nor above any limit. Options of several numbers look themselves.
    if (option->get_type_name().starts_with("FLOAT") && option->get_items_expected_max() == 1 &&
        std::ranges::any_of(option->results(), is_nan))
      throw InputError(fmt::format("{}: nan is no number", option->get_name()));
  }
}

// A command that overwrites its input would destroy it when it is interrupted, and could not be repeated.
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

// After a signal, the exit status is 128 plus the number of the signal, as in a shell.
int unless_ended(int status) {
  constexpr int kSignalled = 128;
  return interrupt_signal() > 0 ? kSignalled + interrupt_signal() : status;
}

// If a standard descriptor is closed, the next opened file would take its number and receive the messages. This
// function fills the missing descriptors with files on which reading or writing still fails.
void hold_standard_descriptors() {
  for (const int descriptor : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO}) {
    if (::fcntl(descriptor, F_GETFD) == -1 && errno == EBADF)
      (void)::open("/dev/null", descriptor == STDIN_FILENO ? O_WRONLY : O_RDONLY);
  }
}

// Returns the status, or an error if standard output did not accept everything.
int when_written(int status) {
  std::cout.flush();
  if (std::fflush(stdout) == 0 && std::ferror(stdout) == 0 && std::cout) return status;
  return fail("standard output: cannot write; check the disk or the pipe", 2);
}

// Runs one command and turns what it throws into its exit status.
int run_entry(const Entry& entry) {
  try {
    const std::string file = output_of(*entry.app);
    if (file == "-" && entry.json) throw InputError("-o - and --json both want standard output; leave one out");
    require_values(*entry.app);
    require_other_than_inputs(*entry.app, file);
    Output output(entry.json, file == "-");
    const int status = entry.run(output);
    if (output.simulated()) output.result["simulated"] = true;
    if (entry.json) std::fputs((json_line(output.result)).c_str(), stdout);
    if (const int written = when_written(0); written != 0) return written;
    return output.expects_interrupt() && interrupt_signal() == SIGINT ? status : unless_ended(status);
  } catch (const Error& e) {
    return unless_ended(fail(e.what(), e.exit_status()));
  } catch (const std::bad_alloc&) {
    return fail("out of memory; use a smaller input, or give the program more (ulimit -v)", 3);
  } catch (const std::system_error& e) {
    return fail(
        fmt::format("the operating system refused: {}; end other programs, or raise the limits (ulimit -a)", e.what()),
        3);
  } catch (const std::exception& e) {
    return fail(fmt::format("internal error: {}; please report it with the input", e.what()), 2);
  }
}

const char* title_of(Group group) {
  constexpr std::array<const char*, 4> kTitles{"Design", "Hardware", "Data", "Simulation and proofs"};
  return kTitles.at(static_cast<std::size_t>(group));
}

std::vector<std::unique_ptr<Entry>> add_commands(CLI::App& program) {
  std::vector<Command> commands = Registration::all();
  std::ranges::sort(commands, {}, [](const Command& c) { return std::pair(c.group, c.name); });
  std::vector<std::unique_ptr<Entry>> entries;
  for (const Command& command : commands) {
    auto entry = std::make_unique<Entry>();
    entry->app = program.add_subcommand(command.name, command.summary);
    entry->app->group(title_of(command.group));
    entry->app->footer("Example:\n  " + command.example);
    entry->app->add_flag("--json", entry->json, "one JSON object on standard output; messages on standard error");
    entry->run = command.set_up(*entry->app);
    entries.push_back(std::move(entry));
  }
  return entries;
}

bool names_unknown_command(const CLI::App& program, int argc, const char* const* argv) {
  return argc > 1 && argv[1][0] != '-' && find_command(program, argv[1]) == nullptr;
}

// Prints one line with the error, a suggestion, and where to read more.
int refuse(const CLI::App& program, const CLI::ParseError& error, int argc, const char* const* argv) {
  const bool unknown = names_unknown_command(program, argc, argv);
  std::string what = plain_words(error.what());
  if (unknown) what = fmt::format("there is no command {}", argv[1]);
  if (argc == 1) what = "no command is given";
  if (argc > 1 && argv[1][0] == '-') what = fmt::format("{} is not known here", argv[1]);
  if (const std::string question = did_you_mean(program, argc, argv, what.ends_with("is not known here"));
      !question.empty())
    what += "; " + question;
  const std::string command = unknown || argc == 1 || argv[1][0] == '-' ? "" : fmt::format(" {}", argv[1]);
  return fail(fmt::format("{}\nRun triskin{} --help for more.", what, command), 2);
}

}  // namespace

int run_program(const std::string& description, int argc, char** argv) {
  hold_standard_descriptors();
  // A file beyond the limit of the shell (ulimit -f) is then refused with an error, which has a message.
  (void)std::signal(SIGXFSZ, SIG_IGN);
  CLI::App program{description};
  program.name(std::filesystem::path(argv[0]).filename().string());
  const auto format = std::make_shared<HelpFormat>(help_columns());
  format->label("SUBCOMMAND", "COMMAND");
  program.formatter(format);
  program.set_version_flag("-V,--version", TRISKIN_VERSION);
  program.require_subcommand(1);
  program.footer("triskin help COMMAND shows its options and an example; triskin help links,\nwhat --link takes.");
  // Commands take the variables while they are added. Help is given whatever the file says.
  std::string mistake_in_settings;
  try {
    read_settings();
  } catch (const Error& e) {
    mistake_in_settings = e.what();
  }
  const auto entries = add_commands(program);
  add_settings(program);
  if (const auto status = answer_help(program, argc, argv)) return when_written(*status);
  if (const auto status = answer_generate_docs(program, argc, argv)) return when_written(*status);
  if (!mistake_in_settings.empty()) return fail(mistake_in_settings, 2);
  argc = take_ros_arguments(argc, argv);
  try {
    program.parse(argc, argv);
  } catch (const CLI::ParseError& e) {
    // The --help behind a command that does not exist would show the commands and hide the mistake.
    if (e.get_exit_code() == 0 && !names_unknown_command(program, argc, argv)) return when_written(program.exit(e));
    return refuse(program, e, argc, argv);
  }
  for (const auto& entry : entries) {
    if (entry->app->parsed()) return run_entry(*entry);
  }
  return 2;
}

}  // namespace triskin::cli
