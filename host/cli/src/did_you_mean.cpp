// SPDX-License-Identifier: GPL-3.0-or-later
#include "did_you_mean.hpp"

#include <algorithm>
#include <numeric>
#include <vector>

namespace triskin::cli {
namespace {

// Counts the letters to insert, delete, replace, or swap with the next (optimal string alignment).
std::size_t distance(const std::string& a, const std::string& b) {
  std::vector<std::vector<std::size_t>> d(a.size() + 1, std::vector<std::size_t>(b.size() + 1));
  for (std::size_t i = 0; i <= a.size(); ++i) d[i][0] = i;
  std::iota(d[0].begin(), d[0].end(), std::size_t{0});
  for (std::size_t i = 1; i <= a.size(); ++i) {
    for (std::size_t j = 1; j <= b.size(); ++j) {
      d[i][j] = std::min({d[i - 1][j] + 1, d[i][j - 1] + 1, d[i - 1][j - 1] + (a[i - 1] == b[j - 1] ? 0U : 1U)});
      if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1])
        d[i][j] = std::min(d[i][j], d[i - 2][j - 2] + 1);
    }
  }
  return d[a.size()][b.size()];
}

// Returns an empty text if no name is similar enough to be a typing error.
std::string nearest(const std::string& word, const std::vector<std::string>& names) {
  const auto closer = [&](const std::string& a, const std::string& b) { return distance(word, a) < distance(word, b); };
  const auto best = std::ranges::min_element(names, closer);
  const std::size_t most = std::max<std::size_t>(1, word.size() / 3);
  return best != names.end() && distance(word, *best) <= most ? *best : std::string{};
}

std::vector<std::string> options_of(const CLI::App& app) {
  std::vector<std::string> names;
  for (const CLI::Option* option : app.get_options()) {
    for (const std::string& name : option->get_lnames()) names.push_back("--" + name);
  }
  return names;
}

std::string question(const std::string& word, const std::vector<std::string>& names) {
  if (std::ranges::find(names, word) != names.end()) return {};
  const std::string name = nearest(word, names);
  return name.empty() ? std::string{} : "did you mean " + name + "?";
}

}  // namespace

std::string did_you_mean(const CLI::App& program, int argc, const char* const* argv) {
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
    const std::string word = argv[k];
    if (!word.starts_with("--")) continue;
    const std::string asked = question(word.substr(0, word.find('=')), options_of(*app));
    if (!asked.empty()) return asked;
  }
  return {};
}

}  // namespace triskin::cli
