// SPDX-License-Identifier: GPL-3.0-or-later
#include "finding_lines.hpp"

#include <fmt/format.h>

#include "triskin/design/module_number.hpp"

namespace triskin::cli {

nlohmann::json finding_json(const design::Design& design, const diagnose::Finding& f) {
  nlohmann::json j = {{"kind", diagnose::kFindingKindNames.name(f.kind)}, {"text", f.text}, {"remedy", f.remedy}};
  j["module"] = f.module >= 0 ? nlohmann::json(design::number_of(design, f.module)) : nlohmann::json(nullptr);
  j["patch"] = f.patch >= 0 ? nlohmann::json(f.patch) : nlohmann::json(nullptr);
  if (f.other >= 0) j["other"] = design::number_of(design, f.other);
  if (f.line >= 0) j["line"] = f.line;
  if (f.address >= 0) j["address"] = f.address;
  if (f.taxel >= 0) j["taxel"] = f.taxel;
  if (!f.behind.empty()) j["behind"] = design::numbers_of(design, f.behind);
  if (f.held_design != 0) j["held_design"] = fmt::format("{:016x}", f.held_design);
  if (!f.held_file.empty()) j["held_file"] = f.held_file;
  if (!f.place.empty()) j["place"] = f.place;
  return j;
}

std::vector<std::string> finding_lines(const diagnose::Finding& f, const std::vector<std::string>& steps) {
  std::vector<std::string> lines{fmt::format("{}: {}", diagnose::kFindingKindNames.name(f.kind), f.text)};
  if (!f.place.empty()) lines.push_back("    on the cover: " + f.place);
  lines.push_back("    " + f.remedy);
  for (std::size_t k = 0; k < steps.size(); ++k) lines.push_back(fmt::format("      {}. {}", k + 1, steps[k]));
  return lines;
}

}  // namespace triskin::cli
