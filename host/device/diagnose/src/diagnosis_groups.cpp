// SPDX-License-Identifier: GPL-3.0-or-later
// Finds one cause for many modules: breaks that make modules of a switched patch unreachable, and taxels with shifted
// rest values.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

#include "cover_place.hpp"
#include "missing_modules.hpp"
#include "triskin/base/counted.hpp"
#include "triskin/design/off_rest.hpp"
#include "verification.hpp"

namespace triskin::diagnose {
namespace {

using Counts = std::array<double, layout::kTaxelsPerModule>;

// Returns how much the temperature pads have changed since rest; the same warming affects the other taxels.
double warming_counts(const wire::ModuleTaxels& now, const Counts& rest) {
  double sum = 0.0;
  int pads = 0;
  for (std::size_t t = 0; t < layout::kTaxelsPerModule; ++t) {
    if (layout::measures_pressure(t) || !now.is_valid(t)) continue;
    sum += now.value[t] - rest[t];
    ++pads;
  }
  return pads == 0 ? 0.0 : sum / pads;
}

int taxels_off_rest(const wire::ModuleTaxels& now, const Counts& rest) {
  const double warming = warming_counts(now, rest);
  int off = 0;
  for (std::size_t t = 0; t < layout::kTaxelsPerModule; ++t) {
    if (!layout::measures_pressure(t) || !now.is_valid(t)) continue;
    off += std::abs(now.value[t] - rest[t] - warming) >= kMaxRestError_counts ? 1 : 0;
  }
  return off;
}

// Returns the module and those above it, up to the entry.
std::vector<int> way_to_entry(const std::vector<design::RoutedModule>& tree, int module) {
  std::vector<int> way;
  while (module >= 0) {
    way.push_back(module);
    module = std::ranges::find(tree, module, &design::RoutedModule::node)->parent;
  }
  return way;
}

}  // namespace

std::optional<Diagnosis::Branch> Diagnosis::open_line(const PatchState& p, int line,
                                                      const std::set<layout::ModuleId>& modules) const {
  constexpr std::size_t kMinModules = 3;  // Two of a line may just as well be dead.
  const auto& tree = design_.patches[static_cast<std::size_t>(p.patch)].modules;
  Branch found;
  std::vector<int> common;  // The modules through which all of them are reached, the farthest from the entry first.
  for (const auto& m : tree) {
    if (m.line != line || !modules.contains(layout::ModuleId{m.node})) continue;
    const std::vector<int> way = way_to_entry(tree, m.node);
    if (found.members.empty()) common = way;
    std::erase_if(common, [&](int k) { return std::ranges::find(way, k) == way.end(); });
    found.members.emplace_back(m.node);
  }
  // Modules behind different entries of a patch have no place in common.
  if (found.members.size() < kMinModules || common.empty()) return std::nullopt;
  found.module = layout::ModuleId{common.front()};
  found.parent = layout::ModuleId{common.size() > 1 ? common[1] : -1};
  for (const auto& m : tree) {
    const std::vector<int> way = way_to_entry(tree, m.node);
    const bool is_behind = std::ranges::find(way, found.module) != way.end();
    if (m.line == line && is_behind && !modules.contains(layout::ModuleId{m.node})) return std::nullopt;
  }
  return found;
}

// A line is the cause if that needs fewer causes than joints and modules do. The module at the joint may be alive.
void Diagnosis::add_open_lines(FindingKind kind, const PatchState& p, std::set<layout::ModuleId>& modules,
                               const std::string& what) {
  for (int line = 0; line < layout::kLines; ++line) {
    const auto open = open_line(p, line, modules);
    if (!open) continue;
    std::set<layout::ModuleId> others = modules;
    for (const layout::ModuleId m : open->members) others.erase(m);
    if (branches(p, others).size() + 1 >= branches(p, modules).size()) continue;
    const std::string at =
        open->parent < 0 ? "the cable of the patch" : joint_text(design_, open->parent, open->module);
    add_open_line(kind, p.patch, line, *open,
                  fmt::format("patch {}: {} the {} of line L{} behind {} ({}); its other lines pass there", p.patch,
                              what, counted(open->members.size(), "module"), line, at, fmt::join(open->members, ", ")));
    modules = std::move(others);
  }
}

void Diagnosis::add_open_line(FindingKind kind, layout::PatchIndex patch, int line, const Branch& open,
                              std::string text) {
  Finding& f = add(
      kind, layout::ModuleId::none(), patch, std::move(text),
      fmt::format("measure SDA and SCL of line L{} along the way from the cable to this place: one of the two is open, "
                  "at this joint or before it",
                  line));
  f.module = open.module;
  f.other = open.parent;
  f.line = line;
  f.place = place_on_cover(design_, open.module);
  f.behind = open.members;
  std::erase(f.behind, f.module);
  bad_.insert(open.members.begin(), open.members.end());
  explained_.insert(open.members.begin(), open.members.end());
}

std::string Diagnosis::broken_joint_text(const MissingCause& c, const std::vector<layout::ModuleId>& concerned) const {
  std::string text = fmt::format("nothing passes {}", joint_text(design_, c.module, c.other));
  if (concerned.empty()) return text;
  return text + fmt::format("; behind it {} {} out of reach: {}", counted(concerned.size(), "module"),
                            agreeing(concerned.size(), "is", "are"), fmt::join(concerned, ", "));
}

std::string Diagnosis::broken_module_text(const MissingCause& c) {
  const std::string text = fmt::format("module {} was not found: it or all of its joints are broken", c.module);
  return c.behind.empty() ? text : text + fmt::format("; behind it are out of reach: {}", fmt::join(c.behind, ", "));
}

// Modules that a backup table leaves out already have their finding.
void Diagnosis::examine_missing(const PatchState& p, const std::set<layout::ModuleId>& missing) {
  std::set<layout::ModuleId> alive;
  for (const layout::ModuleId m : missing) {
    if (adopter_.contains(m)) alive.insert(m);
  }
  for (MissingCause& c : explain_missing(design_, p.patch, missing, alive)) {
    std::vector<layout::ModuleId> concerned = c.behind;
    if (c.kind == FindingKind::kMissingModule) concerned.push_back(c.module);
    if (std::ranges::none_of(concerned, [&](layout::ModuleId m) { return p.reads(m); })) continue;
    std::erase(c.behind, c.module);
    const bool joint = c.kind == FindingKind::kMissingJoint;
    std::string text = joint ? broken_joint_text(c, concerned) : broken_module_text(c);
    if (!alive.empty())
      text += fmt::format("; the controller of patch {} reads {} meanwhile", adopter_.at(*alive.begin()),
                          fmt::join(alive, ", "));
    Finding& f = add(c.kind, c.module, p.patch, fmt::format("patch {}: {}", p.patch, text),
                     joint ? fmt::format("solder this joint anew; if that does not help, module {} is dead", c.module)
                           : "check its supply and its joints, then the module");
    f.other = c.other;
    f.behind = c.behind;
  }
  bad_.insert(missing.begin(), missing.end());
  explained_.insert(missing.begin(), missing.end());
}

// A module with its own fault is repaired first and has other rest values afterwards.
// Bad modules have findings of their own, so they do not count.
design::OffRest Diagnosis::off_rest() const {
  design::OffRest all;
  for (const PatchState& p : patches_) {
    for (std::size_t row = 0; p.usable && row < std::min(p.now.count, p.image.module_count); ++row) {
      const layout::ModuleId module = p.module(row);
      if (bad_.contains(module)) continue;
      const int off = taxels_off_rest(p.now.modules[row], rest_.at(static_cast<std::size_t>(module)));
      if (off > 0) all.modules.push_back(module);
      all.taxels += off;
    }
  }
  std::ranges::sort(all.modules);
  return all;
}

void Diagnosis::examine_rest() {
  if (rest_.empty()) return;
  const design::OffRest all = off_rest();
  if (all.modules.empty()) return;
  // The modules themselves work, so modules_ok includes them.
  Finding& f = add(FindingKind::kStaleRest, layout::ModuleId::none(), layout::PatchIndex::none(), sentence(all),
                   "take everything off the skin and tare; what was exchanged or taken away since the last tare rests "
                   "elsewhere");
  f.module = all.modules.front();
  f.place = place_on_cover(design_, f.module);
  f.behind.assign(all.modules.begin() + 1, all.modules.end());
}

}  // namespace triskin::diagnose
