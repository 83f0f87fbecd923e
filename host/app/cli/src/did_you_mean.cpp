// SPDX-License-Identifier: GPL-3.0-or-later
#include "did_you_mean.hpp"

#include <algorithm>
#include <cctype>
#include <vector>

#include "triskin/base/nearest_name.hpp"
#include "triskin/base/short_list.hpp"

namespace triskin::cli {
namespace {

std::vector<std::string> options_of(const CLI::App& app) {
  std::vector<std::string> names;
  for (const CLI::Option* option : app.get_options()) {
    for (const std::string& name : option->get_lnames()) names.push_back("--" + name);
  }
  return names;
}

std::string question(const std::string& word, const std::vector<std::string>& names) {
  if (std::ranges::find(names, word) != names.end()) return {};
  const std::string name = nearest_name(word, names, word.size());
  return name.empty() ? std::string{} : "did you mean " + name + "?";
}

// Says which commands know an option that another command was given.
std::string belongs_elsewhere(const CLI::App& program, const std::string& option) {
  std::vector<std::string> commands;
  for (const CLI::App* sub : program.get_subcommands([](const CLI::App*) { return true; })) {
    const std::vector<std::string> options = options_of(*sub);
    if (std::ranges::find(options, option) != options.end()) commands.push_back(sub->get_name());
  }
  return commands.empty() ? std::string{} : "it is an option of " + short_list(commands, 4);
}

}  // namespace

std::string did_you_mean(const CLI::App& program, int argc, const char* const* argv, bool is_unknown) {
  if (argc < 2) return {};
  const std::string command = argv[1];
  const CLI::App* app = nullptr;
  std::vector<std::string> names = options_of(program);
  for (const CLI::App* sub : program.get_subcommands([](const CLI::App*) { return true; })) {
    names.push_back(sub->get_name());
    if (sub->get_name() == command) app = sub;
  }
  if (app == nullptr) return question(command, names);
  for (int k = 2; k < argc; ++k) {
    std::string word = argv[k];
    // A long name with one dash, as "-link", is a usual slip.
    if (word.size() > 2 && word[0] == '-' && std::isalpha(static_cast<unsigned char>(word[1])) != 0) word = "-" + word;
    if (!word.starts_with("--")) continue;
    const std::vector<std::string> options = options_of(*app);
    word = word.substr(0, word.find('='));
    const bool one_dash = word != std::string(argv[k]).substr(0, word.size());
    if (one_dash && std::ranges::find(options, word) != options.end()) return "did you mean " + word + "?";
    std::string asked = question(word, options);
    if (!asked.empty()) return asked;
    if (std::ranges::find(options, word) == options.end() && is_unknown) return belongs_elsewhere(program, word);
  }
  return {};
}

}  // namespace triskin::cli
