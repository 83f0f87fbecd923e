// SPDX-License-Identifier: GPL-3.0-or-later
#include "checked_output.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <map>
#include <optional>
#include <sstream>
#include <string_view>

#include "triskin/base/counted.hpp"
#include "triskin/base/error.hpp"
#include "triskin/base/files.hpp"
#include "triskin/design/design_text.hpp"
#include "triskin/design/module_number.hpp"
#include "triskin/pipeline/edit_design.hpp"

namespace triskin::cli {
namespace {

constexpr int kMaxRounds = 20;
// Wishes of the user that a surface may not allow: the design says so and the exit status is 1.
constexpr std::array<std::string_view, 2> kWishes{"must-cover", "entry-place"};

bool is_wish(const check::Violation& v) {
  return std::ranges::find(kWishes, v.rule) != kWishes.end();
}

// Returns the module of "module 12" or "module 3 side 1".
std::optional<int> module_of(const check::Violation& v) {
  std::istringstream words(v.where);
  std::string word;
  int module = -1;
  if (words >> word >> module && word == "module") return module;
  return std::nullopt;
}

[[noreturn]] void refuse(const std::string& path, OnViolation on_violation,
                         const std::vector<check::Violation>& violations) {
  const auto first = std::ranges::find_if_not(violations, is_wish);
  const auto more = std::ranges::count_if(violations, [](const auto& v) { return !is_wish(v); }) - 1;
  throw InputError(
      fmt::format("{} was not written, because triskin check would reject it: {}, {}: {}{}. {}", path, first->where,
                  first->rule, first->text, more > 0 ? fmt::format(" (and {} more)", more) : "",
                  on_violation == OnViolation::kRefuse
                      ? "See whether triskin check rejects the given design too; if not, leave that module out"
                      : "Another --seed may avoid it; please report it with the mesh"));
}

}  // namespace

OutputCheck write_checked_design(const std::string& path, design::Design& design, OnViolation on_violation,
                                 const ProgressSink& progress) {
  const auto start = std::chrono::steady_clock::now();
  OutputCheck result;
  std::string text;
  const bool is_new = design.next_number == 0;  // Labels of a revised design exist already.
  for (int round = 0;; ++round) {
    report(progress, "checking", -1.0, counted(design.layout.modules.size(), "module"));
    text = design::design_text(design);
    result.report = check::check_design_text(text, path);
    const auto& violations = result.report.violations;
    if (std::ranges::all_of(violations, is_wish)) break;
    std::map<int, std::vector<std::string>> broken;
    std::size_t most = 0;
    for (const check::Violation& v : violations) {
      const auto module = module_of(v);
      if (!module || is_wish(v)) continue;
      broken[*module].push_back(v.rule);
      most = std::max(most, broken[*module].size());
    }
    if (on_violation == OnViolation::kRefuse || broken.empty() || round == kMaxRounds)
      refuse(path, on_violation, violations);
    // What a module breaks is also found at its neighbours, so the one with most findings goes first.
    pipeline::LayoutEdit edit;
    for (const auto& [module, rules] : broken) {
      if (rules.size() < most) continue;
      edit.remove.push_back(design::require_module(design, {module}));
      result.removed.push_back(rules.front());
    }
    if (edit.remove.size() == design.layout.modules.size()) refuse(path, on_violation, violations);
    const double seconds = design.report.seconds;
    design = pipeline::edit_design(design, edit, progress).design;
    if (is_new) {
      design.layout.numbers.clear();
      design.next_number = 0;
      design.design_id = design::design_id_of(design);
    }
    design.report.seconds += seconds;
  }
  result.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  write_output(path, text);
  return result;
}

}  // namespace triskin::cli
