// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <span>

#include "triskin/base/error.hpp"
#include "triskin/design/module_number.hpp"
#include "triskin/view/notes.hpp"

namespace triskin::view {
namespace {

using nlohmann::json;

// These offsets convert the numbers of one cover to those of the displayed design.
struct Place {
  int first_module = 0, first_patch = 0, modules = 0, patches = 0;
};

[[noreturn]] void throw_no_report(const std::string& name) {
  throw InputError(
      fmt::format("{}: not a report of triskin verify; write one with triskin verify DESIGN --report FILE.json", name));
}

// The number of a module is that of its label; the modules of the covers stand one after the other.
layout::SkinModule module_in(const json& finding, const design::Design& design, const Place& place,
                             const std::string& name) {
  const auto found = finding.find("module");
  if (found == finding.end() || found->is_null()) return layout::SkinModule::none();
  if (!found->is_number_integer()) throw_no_report(name);
  for (int k = place.first_module; k < place.first_module + place.modules; ++k) {
    if (std::int64_t{design::number_of(design, k).value} == found->get<std::int64_t>()) return layout::SkinModule{k};
  }
  throw InputError(fmt::format("{}: a finding is about module {}, which is not there; this report is of another design",
                               name, found->dump()));
}

// A null and a missing key both mean "none".
int number_in(const json& finding, const char* key, int first, int count, const std::string& name) {
  const auto found = finding.find(key);
  if (found == finding.end() || found->is_null()) return -1;
  if (!found->is_number_integer()) throw_no_report(name);
  const auto value = found->get<std::int64_t>();
  if (value < 0 || value >= count)
    throw InputError(fmt::format("{}: a finding is about {} {}, and there are {}; this report is of another design",
                                 name, key, value, count));
  return first + static_cast<int>(value);
}

std::string text_in(const json& finding, const char* key) {
  const auto found = finding.find(key);
  return found != finding.end() && found->is_string() ? found->get<std::string>() : "";
}

void append(std::vector<Finding>& all, const json& report, const design::Design& design, const Place& place,
            const std::string& name) {
  const auto findings = report.find("findings");
  if (findings == report.end() || !findings->is_array()) throw_no_report(name);
  for (const json& f : *findings) {
    if (!f.is_object()) throw_no_report(name);
    all.push_back({module_in(f, design, place, name),
                   layout::PatchIndex{number_in(f, "patch", place.first_patch, place.patches, name)},
                   text_in(f, "text"), text_in(f, "remedy")});
  }
}

Place place_of(const std::string& cover, std::span<const CoverNote> covers, const design::Design& design,
               const std::string& name) {
  const auto found = std::ranges::find(covers, cover, &CoverNote::name);
  if (found == covers.end())
    throw InputError(fmt::format("{}: it speaks of the cover \"{}\", which this robot does not have", name, cover));
  const auto next = std::next(found);
  const int end = next == covers.end() ? static_cast<int>(design.patches.size()) : next->first_patch;
  return {found->first_module, found->first_patch, found->modules, end - found->first_patch};
}

}  // namespace

std::vector<Finding> findings_in(std::string_view report, const std::string& name, const design::Design& design,
                                 const Notes& notes) {
  const std::vector<CoverNote>& covers = notes.covers;
  const json root = json::parse(report, nullptr, false);
  if (!root.is_object()) throw_no_report(name);
  std::vector<Finding> all;
  const bool is_comparison = !notes.changes.modules.empty();
  const std::string cover = is_comparison ? covers.back().name : text_in(root, "cover");
  if (const auto list = root.find("covers"); list != root.end() && list->is_array()) {
    for (const json& of_cover : *list) {
      if (!of_cover.is_object()) throw_no_report(name);
      append(all, of_cover, design, place_of(text_in(of_cover, "cover"), covers, design, name), name);
    }
  } else if (!cover.empty() && !covers.empty()) {
    append(all, root, design, place_of(cover, covers, design, name), name);
  } else {
    append(all, root, design,
           {0, 0, static_cast<int>(design.layout.modules.size()), static_cast<int>(design.patches.size())}, name);
  }
  return all;
}

}  // namespace triskin::view
