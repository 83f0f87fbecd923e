// SPDX-License-Identifier: GPL-3.0-or-later
#include "triskin/design/kinds.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "triskin/base/error.hpp"
#include "triskin/base/text_file.hpp"
#include "triskin/design/file_head.hpp"
#include "triskin/design/json_fields.hpp"
#include "triskin/design/module_number.hpp"
#include "triskin/layout/patch_image.hpp"

namespace triskin::design {
namespace {

constexpr const char* kKindsPage = "docs/pipeline.md";
constexpr double kMaxSensitivity = 1e6;

ModuleKind read_kind(const JsonValue& v) {
  only_keys(v, {"name", "taxels", "dielectric", "sensitivity_counts_per_kpa"}, kKindsPage);
  ModuleKind k;
  k.name = v["name"].text();
  if (k.name.empty() || k.name.size() > 64 || k.name.find_first_of(",\"\n\r") != std::string::npos)
    v["name"].fail("must have 1 … 64 bytes, without comma, quote or line break");
  if (k.name == KindPlan::kStandard) v["name"].fail("\"standard\" is the name of what has no other kind");
  if (has(v, "taxels")) k.taxels = v["taxels"].integer(1, layout::kTaxelsPerModule);
  if (has(v, "dielectric")) k.dielectric = v["dielectric"].text();
  if (has(v, "sensitivity_counts_per_kpa"))
    k.sensitivity_counts_per_kpa = number_in(v["sensitivity_counts_per_kpa"], 0.0, kMaxSensitivity);
  return k;
}

void require_known(const CoverPart& region, std::size_t number, const ModuleLayout& layout) {
  const auto refuse = [&](const std::string& what) {
    throw InputError(fmt::format("kinds: region {}: {}; name what the design has", number, what));
  };
  if (const auto* island = std::get_if<IslandPart>(&region); island != nullptr && island->island >= layout.islands)
    refuse(fmt::format("there is no island {}; the design has {}", island->island, layout.islands));
  if (const auto* list = std::get_if<ModulePart>(&region)) {
    for (const int module : list->modules) {
      if (module_with(layout, {module}) < 0) {
        refuse(fmt::format("there is no module {}; the design has {}", module, ranges_text(all_numbers(layout))));
      }
    }
  }
}

std::vector<ModuleKind> read_own_kinds(const JsonValue& v) {
  constexpr std::size_t kMaxOwnKinds = layout::kMaxKinds - 1;
  if (v.size() == 0 || v.size() > kMaxOwnKinds)
    v.fail(fmt::format("must have 1 … {} elements: a table has no room for more", kMaxOwnKinds));
  std::vector<ModuleKind> kinds;
  for (std::size_t k = 0; k < v.size(); ++k) {
    ModuleKind kind = read_kind(v.at(k));
    if (std::ranges::find(kinds, kind.name, &ModuleKind::name) != kinds.end()) v.at(k)["name"].fail("appears twice");
    kinds.push_back(std::move(kind));
  }
  return kinds;
}

void read_kind_regions(const JsonValue& v, KindPlan& plan) {
  for (std::size_t k = 0; k < v.size(); ++k) {
    const JsonValue region = v.at(k);
    only_keys(region, {"kind", "sphere", "box", "island", "modules"}, kKindsPage);
    const JsonValue name = region["kind"];
    const std::optional<int> kind = number_of_kind(plan, name.text());
    if (!kind) name.fail(fmt::format("\"{}\" is not among \"kinds\"", name.text()));
    plan.regions.push_back({read_cover_part(region), *kind});
  }
}

}  // namespace

ModuleKind kind_of(const KindPlan& plan, int kind) {
  if (kind == 0) return {std::string(KindPlan::kStandard), layout::kTaxelsPerModule, "", 0.0};
  return plan.kinds.at(static_cast<std::size_t>(kind) - 1);
}

std::optional<int> number_of_kind(const KindPlan& plan, std::string_view name) {
  if (name == KindPlan::kStandard) return 0;
  const auto found = std::ranges::find(plan.kinds, name, &ModuleKind::name);
  if (found == plan.kinds.end()) return std::nullopt;
  return static_cast<int>(found - plan.kinds.begin()) + 1;
}

KindPlan kind_plan_of(const JsonValue& v) {
  KindPlan plan;
  plan.kinds = read_own_kinds(v["kinds"]);
  if (has(v, "regions")) read_kind_regions(v["regions"], plan);
  return plan;
}
KindPlan read_kind_plan(const std::filesystem::path& path) {
  const nlohmann::json document = parse_json(read_text(path), path.string());
  const JsonValue v(document, path.string());
  only_keys(v, {"format", "version", "kinds", "regions"}, kKindsPage);
  require_head(v, "triskin-kinds", 1, std::string(kKindsPage) + " describes it");
  return kind_plan_of(v);
}

nlohmann::json kind_plan_json(const KindPlan& plan) {
  nlohmann::json kinds = nlohmann::json::array(), regions = nlohmann::json::array();
  for (const ModuleKind& k : plan.kinds) {
    kinds.push_back({{"name", k.name},
                     {"taxels", k.taxels},
                     {"dielectric", k.dielectric},
                     {"sensitivity_counts_per_kpa", k.sensitivity_counts_per_kpa}});
  }
  for (const KindRegion& r : plan.regions) {
    nlohmann::json region = cover_part_json(r.region);
    region["kind"] = kind_of(plan, r.kind).name;
    regions.push_back(std::move(region));
  }
  return {{"kinds", std::move(kinds)}, {"regions", std::move(regions)}};
}

void assign_kinds(const KindPlan& plan, ModuleLayout& layout) {
  for (PlacedModule& m : layout.modules) m.kind = 0;
  for (std::size_t r = 0; r < plan.regions.size(); ++r) {
    require_known(plan.regions[r].region, r, layout);
    for (int id = 0; id < static_cast<int>(layout.modules.size()); ++id) {
      if (holds(plan.regions[r].region, layout, id))
        layout.modules[static_cast<std::size_t>(id)].kind = plan.regions[r].kind;
    }
  }
}

void assign_kinds_by_place(const KindPlan& plan, ModuleLayout& layout, std::size_t first) {
  for (std::size_t id = first; id < layout.modules.size(); ++id) {
    layout.modules[id].kind = 0;
    for (const auto& [region, kind] : plan.regions) {
      if (is_place(region) && holds(region, layout, static_cast<int>(id))) layout.modules[id].kind = kind;
    }
  }
}

std::vector<int> count_kinds(const KindPlan& plan, const ModuleLayout& layout) {
  std::vector<int> counts(plan.kinds.size() + 1, 0);
  for (const PlacedModule& m : layout.modules) ++counts.at(static_cast<std::size_t>(m.kind));
  return counts;
}

}  // namespace triskin::design
