// SPDX-License-Identifier: GPL-3.0-or-later
#include "settings.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <filesystem>
#include <sstream>
#include <string>

#include "triskin/base/error.hpp"
#include "triskin/base/text_file.hpp"

namespace triskin::cli {
namespace {

namespace fs = std::filesystem;

struct Setting {
  const char *name, *variable, *option;
};
// The library reads the variable of links too, so no option takes it from here.
constexpr std::array<Setting, 2> kSettings{{{"link", "TRISKIN_LINK", nullptr}, {"paper", "TRISKIN_PAPER", "--paper"}}};

// Returns an empty path if the environment names no folder.
fs::path settings_file() {
  const char *folder = std::getenv("XDG_CONFIG_HOME"), *home = std::getenv("HOME");
  if (folder != nullptr && *folder != '\0') return fs::path(folder) / "triskin" / "config";
  return home != nullptr && *home != '\0' ? fs::path(home) / ".config" / "triskin" / "config" : fs::path{};
}

std::string trimmed(const std::string& text) {
  constexpr const char* kSpaces = " \t\r";
  const std::size_t first = text.find_first_not_of(kSpaces);
  return first == std::string::npos ? "" : text.substr(first, text.find_last_not_of(kSpaces) - first + 1);
}

void take_line(const std::string& line, const std::string& place) {
  const std::size_t equals = line.find('=');
  const std::string name = trimmed(line.substr(0, equals));
  const auto* const setting = std::ranges::find_if(kSettings, [&](const Setting& s) { return name == s.name; });
  if (equals == std::string::npos || setting == kSettings.end()) {
    std::array<const char*, kSettings.size()> names{};
    std::ranges::transform(kSettings, names.begin(), &Setting::name);
    throw InputError(fmt::format("{}: \"{}\" is not understood; give NAME = VALUE with one of {}", place, line,
                                 fmt::join(names, ", ")));
  }
  const char* const given = std::getenv(setting->variable);
  constexpr int kReplace = 1;  // An empty variable counts as none, as in a shell's ${NAME:-default}.
  if (given == nullptr || *given == '\0')
    ::setenv(setting->variable, trimmed(line.substr(equals + 1)).c_str(), kReplace);
}

}  // namespace

void read_settings() {
  const fs::path file = settings_file();
  std::error_code none;
  if (file.empty() || !fs::is_regular_file(file, none)) return;
  std::istringstream lines(read_text(file));
  std::string line;
  for (int number = 1; std::getline(lines, line); ++number) {
    line = trimmed(line.substr(0, line.find('#')));
    if (!line.empty()) take_line(line, fmt::format("{}: line {}", file.string(), number));
  }
}

void add_settings(CLI::App& program) {
  for (CLI::App* command : program.get_subcommands([](const CLI::App*) { return true; })) {
    for (const Setting& s : kSettings) {
      CLI::Option* const option = s.option == nullptr ? nullptr : command->get_option_no_throw(s.option);
      if (option != nullptr) option->envname(s.variable);
    }
  }
}

}  // namespace triskin::cli
