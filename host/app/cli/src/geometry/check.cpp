// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <memory>

#include "bus_report.hpp"
#include "command.hpp"
#include "sharp_joints_text.hpp"
#include "triskin/base/counted.hpp"
#include "triskin/base/text_file.hpp"
#include "triskin/check/design_rules.hpp"
#include "triskin/check/flat_layout.hpp"

namespace triskin::cli::check_command {
namespace {

nlohmann::json report_violations(const std::vector<check::Violation>& violations, const Output& output) {
  nlohmann::json list = nlohmann::json::array();
  for (const check::Violation& v : violations) {
    list.push_back({{"rule", v.rule}, {"where", v.where}, {"text", v.text}});
    if (!output.json()) output.say(fmt::format("{}: {}: {}", v.rule, v.where, v.text));
  }
  return list;
}

// A layout of `triskin place --lattices`.
int run_flat(const std::string& text, const std::string& path, Output& output) {
  const check::FlatLayoutReport flat = check::check_flat_layout(text, path);
  output.result = {{"modules", flat.report.modules},
                   {"lattices", flat.lattices},
                   {"upper_bound", flat.upper_bound},
                   {"own_upper_bound", flat.own_upper_bound},
                   {"gap_mm", flat.gap_mm},
                   {"tolerance_mm", flat.tolerance_mm},
                   {"rules", flat.report.rules.size()},
                   {"rule_names", flat.report.rules},
                   {"violations", report_violations(flat.report.violations, output)}};
  output.say(fmt::format("{} on {} with a gap of {:g} mm, no more than {} possible; {} checked, {}",
                         counted(flat.report.modules, "module"), counted(flat.lattices, "lattice"), flat.gap_mm,
                         flat.upper_bound, counted(flat.report.rules.size(), "rule"),
                         counted(flat.report.violations.size(), "violation")));
  return flat.report.violations.empty() && flat.report.modules > 0 ? 0 : 1;
}

int run(const std::string& path, Output& output) {
  if (const std::string text = read_text(path); check::is_flat_layout(text)) return run_flat(text, path, output);
  const check::DesignReport report = check::check_design(path);
  nlohmann::json limits = nlohmann::json::object();
  for (const auto& [name, value] : report.limits) limits[name] = value;
  output.result = {{"modules", report.modules},
                   {"rules", report.rules.size()},
                   {"rule_names", report.rules},
                   {"limits", std::move(limits)},
                   {"violations", report_violations(report.violations, output)}};
  report_sharp_joints(report, output);
  if (report.corner_cut_mm > 0.0) {
    output.result["corner_cut_mm"] = report.corner_cut_mm;
    output.say(fmt::format("modules measured with corners cut by {:g} mm", report.corner_cut_mm));
  }
  if (report.violations.empty()) add_bus_keys(report.modules, output);
  output.say(fmt::format("{} checked, {}", counted(report.rules.size(), "rule"),
                         counted(report.violations.size(), "violation")));
  if (report.modules == 0)
    output.say("the design has no modules: no rule can be broken, and there is nothing to flash");
  return report.violations.empty() && report.modules > 0 ? 0 : 1;
}

const Registration kCheck{{
    "check",
    "check every rule of a design, by code that shares nothing with the solvers",
    "triskin check forearm.design.json --json",
    [](CLI::App& app) -> Run {
      auto path = std::make_shared<std::string>();
      app.add_option("DESIGN", *path, "design file, or a layout of place --lattices")->required();
      return [path](Output& output) { return run(*path, output); };
    },
    Group::kDesign,
}};

}  // namespace
}  // namespace triskin::cli::check_command
