// SPDX-License-Identifier: GPL-3.0-or-later
// Finds one cause for many modules: a joint, a line, the supply, a break in the chain of a switched patch, and taxels
// with shifted rest values.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

#include "cover_place.hpp"
#include "missing_modules.hpp"
#include "triskin/base/counted.hpp"
#include "triskin/design/off_rest.hpp"
#include "triskin/design/supply.hpp"
#include "triskin/diagnose/topology.hpp"
#include "verification.hpp"

namespace triskin::diagnose {
namespace {

using wire::ModuleState;

// Returns the module and those above it, up to the entry.
std::vector<int> way_to_entry(const std::vector<design::RoutedModule>& tree, int module) {
  std::vector<int> way;
  while (module >= 0) {
    way.push_back(module);
    module = std::ranges::find(tree, module, &design::RoutedModule::node)->parent;
  }
  return way;
}

std::string joint_or_cable(const design::Design& design, layout::ModuleId parent, layout::ModuleId module) {
  return parent < 0 ? "the cable of the patch" : joint_text(design, parent, module);
}

}  // namespace

// Returns the largest subtrees of the patch that consist of `modules` only; a module whose subtree is incomplete is
// listed alone.
std::vector<Diagnosis::Branch> Diagnosis::branches(const PatchState& p, const Modules& modules) const {
  const auto& tree = design_.patches[static_cast<std::size_t>(p.patch)].modules;
  // Children are listed after their parents, so walking backwards visits them first.
  std::map<int, bool> whole;
  for (auto m = tree.rbegin(); m != tree.rend(); ++m) {
    const bool own = whole.try_emplace(m->node, true).first->second && modules.contains(layout::ModuleId{m->node});
    whole[m->node] = own;
    if (m->parent >= 0) whole[m->parent] = whole.try_emplace(m->parent, true).first->second && own;
  }
  std::vector<Branch> found;
  std::map<int, std::size_t> branch_of;
  for (const auto& m : tree) {
    if (!modules.contains(layout::ModuleId{m.node})) continue;
    const auto above = branch_of.find(m.parent);
    if (above != branch_of.end() && whole[m.parent]) {
      found[above->second].members.emplace_back(m.node);
      branch_of[m.node] = above->second;
      continue;
    }
    branch_of[m.node] = found.size();
    found.push_back({layout::ModuleId{m.node}, layout::ModuleId{m.parent}, {layout::ModuleId{m.node}}});
  }
  return found;
}

// Returns modules of one line that are the only ones of it behind a joint: its wires are open there, and others pass.
std::optional<Diagnosis::Branch> Diagnosis::open_line(const PatchState& p, int line, const Modules& modules) const {
  constexpr std::size_t kMinModules = 2;
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

// If `modules` are those that lose most of the supply on the way, it may be too low for them: returns the one that
// loses most, else none. Nobody knows by how much resistances differ from the model; a twentieth of the loss is left
// for it.
layout::ModuleId Diagnosis::farthest_of_supply(const PatchState& p, const Modules& modules) const {
  constexpr double kScatter = 0.05;
  const design::Patch& patch = design_.patches[static_cast<std::size_t>(p.patch)];
  const std::vector<double> volts = design::supply_voltages_v(design_, patch);
  const double highest_v = std::ranges::max(volts), lowest_v = std::ranges::min(volts);
  double best_of_others_v = highest_v, worst_of_them_v = lowest_v;
  layout::ModuleId farthest = layout::ModuleId::none();
  for (std::size_t row = 0; row < volts.size(); ++row) {
    const layout::ModuleId m{patch.modules[row].node};
    if (!modules.contains(m))
      best_of_others_v = std::min(best_of_others_v, volts[row]);
    else
      worst_of_them_v = std::max(worst_of_them_v, volts[row]);
    if (volts[row] == lowest_v) farthest = m;
    // What is behind a module has less than the module.
    if (modules.contains(layout::ModuleId{patch.modules[row].parent}) && !modules.contains(m))
      return layout::ModuleId::none();
  }
  const bool are_last = worst_of_them_v <= best_of_others_v + kScatter * (highest_v - lowest_v);
  return modules.size() > 1 && are_last && modules.contains(farthest) ? farthest : layout::ModuleId::none();
}

// A cause for many is likelier than one for each. A line is the cause if that needs fewer causes than joints and
// modules do; the supply if the modules at the ends of several branches fail; else a joint, or the module itself. Where
// the supply explains the modules behind a joint as well, the finding names both.
void Diagnosis::explain(const PatchState& p, Modules modules, const Group& group) {
  const auto words = [&](const std::vector<layout::ModuleId>& members) {
    return std::pair(counted(members.size(), "module"), list_of(members));
  };
  const auto or_supply = [&](const Modules& members) -> std::string {
    return farthest_of_supply(p, members) < 0 ? "" : "; or the supply is too low there: a chip needs 2.6 V";
  };
  // Nobody can ask a patch without an answer of what kind its modules are.
  const auto or_entry = [&](const Branch& b) {
    return b.parent >= 0
               ? ""
               : fmt::format("; of switched modules, module {}, where the cable enters, may be dead", number(b.module));
  };
  // One cause is likelier than two, but two of a line may just as well be dead.
  const auto or_both = [](const Branch& b) { return b.members.size() > 2 ? "" : "; or both modules fail"; };
  const auto explains_all = [&](int line) {
    const auto open = open_line(p, line, modules);
    return open && open->members.size() == modules.size();
  };
  const bool one_line =
      group.line && !modules.empty() && explains_all(wiring_[static_cast<std::size_t>(*modules.begin())].routed.line);
  const std::size_t ends = branches(p, modules).size();
  if (const layout::ModuleId last = farthest_of_supply(p, modules); last >= 0 && ends > 1 && !one_line) {
    std::vector<layout::ModuleId> members(modules.begin(), modules.end());
    const auto [count, list] = words(members);
    std::erase(members, last);
    add(group.supply, last, fmt::arg("patch", p.patch), fmt::arg("modules", count), fmt::arg("list", list),
        fmt::arg("branches", ends))
        .behind = members;
    return explained_by_this(modules);
  }
  for (int line = 0; group.line && line < layout::kLines; ++line) {
    const auto open = open_line(p, line, modules);
    if (!open) continue;
    Modules others = modules;
    for (const layout::ModuleId m : open->members) others.erase(m);
    if (branches(p, others).size() + 1 >= branches(p, modules).size()) continue;
    const auto [count, list] = words(open->members);
    const std::string or_else =
        fmt::format("{}{}", or_supply({open->members.begin(), open->members.end()}), or_both(*open));
    // The module at the joint may be alive.
    Finding& f =
        add(*group.line, p.patch, fmt::arg("modules", count), fmt::arg("line", line), fmt::arg("list", list),
            fmt::arg("joint", joint_or_cable(design_, open->parent, open->module)), fmt::arg("or_else", or_else));
    f.module = open->module;
    f.other = open->parent;
    f.line = line;
    f.place = place_on_cover(design_, open->module);
    f.behind = open->members;
    std::erase(f.behind, f.module);
    explained_by_this(open->members);
    modules = std::move(others);
  }
  for (const Branch& b : branches(p, modules)) {
    explained_by_this(b.members);
    if (b.members.size() == 1) {
      add(group.alone, b.module);
      continue;
    }
    const auto [count, list] = words(b.members);
    Finding& f = add(group.joint, b.module, fmt::arg("patch", p.patch), fmt::arg("modules", count),
                     fmt::arg("list", list), fmt::arg("joint", joint_or_cable(design_, b.parent, b.module)),
                     fmt::arg("or_else", or_supply({b.members.begin(), b.members.end()}) + or_entry(b)));
    f.other = b.parent;
    f.behind.assign(b.members.begin() + 1, b.members.end());
  }
}

// Returns what a fault that is gone was, and of which module. Present faults have their own findings.
std::optional<std::pair<Seen, layout::ModuleId>> Diagnosis::remembered(const PatchState& p,
                                                                       const wire::FaultRecord& fault) const {
  const auto row = std::size_t{fault.code.row};
  if (row >= p.image.module_count) return std::nullopt;
  if (fault.code.state == ModuleState::kLostConfiguration) return std::pair(Seen::kDipped, p.module(row));
  const bool was_away = fault.code.state == ModuleState::kAbsent || fault.code.state == ModuleState::kWrongId;
  if (!was_away || p.states.state[row] != ModuleState::kOk) return std::nullopt;
  return std::pair(Seen::kAway, p.module(row));
}

void Diagnosis::examine_history(const PatchState& p) {
  Modules away, dipped;
  for (const wire::FaultRecord& fault : p.faults.faults()) {
    const auto past = remembered(p, fault);
    if (!past) continue;
    const auto line = static_cast<std::size_t>(wiring_[static_cast<std::size_t>(past->second)].routed.line);
    const bool freed = p.line_states.lines[line].recoveries > 0;  // The line was held low, which has its own finding.
    if (past->first == Seen::kDipped)
      dipped.insert(past->second);
    else if (!freed)
      away.insert(past->second);
  }
  // Unplugged modules also lost their supply, so that is not reported separately.
  for (const layout::ModuleId m : away) dipped.erase(m);
  explain(p, std::move(away), {Seen::kLineAway, Seen::kSupplyAway, Seen::kJointAway, Seen::kAway});
  explain(p, std::move(dipped), {std::nullopt, Seen::kSupplyDipped, Seen::kJointDipped, Seen::kDipped});
}

std::vector<Finding> Diagnosis::examine_earlier() const {
  std::vector<Finding> earlier;
  for (const PatchState& p : patches_) {
    for (const wire::FaultRecord& fault : p.earlier.faults()) {
      const auto past = remembered(p, fault);
      if (!past) continue;
      Finding f = finding(past->first, fmt::arg("where", where(past->second)));
      f.module = past->second;
      f.patch = p.patch;
      const auto again = [&](const Finding& other) { return other.kind == f.kind && other.module == f.module; };
      if (std::ranges::none_of(findings_, again) && std::ranges::none_of(earlier, again)) earlier.push_back(f);
    }
  }
  return earlier;
}

namespace {

// Modules that are out of reach contradict nothing: a break leaves whatever is before it.
int contradictions(const TopologyMatch& match) {
  return static_cast<int>(std::ranges::count_if(
      match.differences, [](const TopologyDifference& d) { return d.kind != FindingKind::kMissingModule; }));
}

bool fits_another(const wire::FoundTopology& found, const design::Design& design, layout::PatchIndex patch) {
  return std::ranges::any_of(identify_patch(found, design), [patch](const TopologyMatch& match) {
    return match.differences.empty() && match.patch != patch;
  });
}

}  // namespace

// Returns the patch whose modules hang on the controller of `p`. It fits as a whole, and its own controller finds
// others instead of them: a break near the entry may leave a few modules that fit many patches.
layout::PatchIndex Diagnosis::attached_instead(const PatchState& p, const TopologyMatch& match) const {
  const auto none = layout::PatchIndex::none();
  if (p.topology.count == 0 || match.differences.empty()) return none;
  for (const TopologyMatch& best : identify_patch(p.topology, design_)) {
    if (!best.differences.empty() || best.patch == p.patch) return none;
    const PatchState& its = patches_[static_cast<std::size_t>(best.patch)];
    const TopologyMatch own = match_topology(its.topology, design_, best.patch);
    const bool finds_its_modules =
        own.agreeing_joints >= contradictions(own) && !fits_another(its.topology, design_, best.patch);
    if (!its.usable || !(own.differences.empty() || finds_its_modules)) return best.patch;
  }
  return none;
}

// Returns the modules whose switches were found and whose chips do not answer.
std::vector<layout::ModuleId> Diagnosis::found_but_silent(const PatchState& p, const TopologyMatch& match) const {
  std::vector<layout::ModuleId> silent;
  for (std::size_t row = 0; row < p.image.module_count; ++row) {
    const layout::ModuleId m = p.module(row);
    const bool found = std::ranges::find(match.module_of, m) != match.module_of.end();
    if (found && p.states.state[row] == ModuleState::kAbsent && !explained_.contains(m)) silent.push_back(m);
  }
  return silent;
}

// With switched modules, the chain tells more than a silent chip does.
void Diagnosis::examine_topology(const PatchState& p) {
  if (!p.topology.switched) return;
  const TopologyMatch match = match_topology(p.topology, design_, p.patch);
  const layout::PatchIndex other = attached_instead(p, match);
  if (other >= 0 || contradictions(match) > match.agreeing_joints + 1) {
    add(Seen::kOtherPatch, p.patch,
        fmt::arg("what", other >= 0
                             ? fmt::format("its controller hangs on the modules of patch {}", other)
                             : fmt::format("the {} found are not this patch", counted(p.topology.count, "module"))));
    for (const auto& m : design_.patches[static_cast<std::size_t>(p.patch)].modules)
      explained_by_this(std::array{layout::ModuleId{m.node}});
    return;
  }
  Modules missing;
  for (const TopologyDifference& d : match.differences) {
    if (d.kind == FindingKind::kMissingModule) {
      missing.insert(d.module);
      continue;
    }
    Finding f;
    f.kind = d.kind;
    f.patch = p.patch;
    f.module = d.module;
    f.other = d.other;
    f.text = fmt::format("patch {}: {}", p.patch, d.text);
    f.remedy = d.remedy;
    // The modules of the joint may still be readable.
    const bool joint = d.kind == FindingKind::kMissingJoint || d.kind == FindingKind::kExtraJoint;
    if (!joint && d.module >= 0) explained_by_this(std::array{d.module});
    if (!joint && d.other >= 0) explained_.insert(d.other);
    // The table opens the ports of a module as it should lie. Where one is turned, they lead elsewhere, also to modules
    // that have another way.
    if (d.kind == FindingKind::kRotatedModule || d.kind == FindingKind::kSwappedModules) {
      f.behind = found_but_silent(p, match);
      explained_by_this(f.behind);
      if (!f.behind.empty())
        f.text += fmt::format("; with this table {} cannot be read: {}", counted(f.behind.size(), "module"),
                              list_of(f.behind));
    }
    if (joint)
      findings_.push_back(std::move(f));
    else
      add(std::move(f));
  }
  examine_missing(p, missing);
}

// Modules that a backup table leaves out already have their finding.
void Diagnosis::examine_missing(const PatchState& p, const Modules& missing) {
  Modules alive;
  for (const layout::ModuleId m : missing) {
    if (adopter_.contains(m)) alive.insert(m);
  }
  const std::string meanwhile = alive.empty() ? ""
                                              : fmt::format("; the controller of patch {} reads {} meanwhile",
                                                            adopter_.at(*alive.begin()), list_of(alive));
  std::string held;
  for (std::size_t line = 0; line < p.line_states.lines.size(); ++line) {
    if (!missing.empty() && p.line_states.lines[line].recoveries > 0)
      held += fmt::format("; line L{} was held low until this was left out", line);
  }
  if (!held.empty()) left_out_.insert(p.patch);
  for (MissingCause& c : explain_missing(design_, p.patch, missing, alive)) {
    const bool joint = c.kind == FindingKind::kMissingJoint;
    std::vector<layout::ModuleId> concerned = c.behind;
    if (!joint) concerned.push_back(c.module);
    if (std::ranges::none_of(concerned, [&](layout::ModuleId m) { return p.reads(m); })) continue;
    std::string behind;
    if (joint && !concerned.empty())
      behind = fmt::format("; behind it {} {} out of reach: {}", counted(concerned.size(), "module"),
                           agreeing(concerned.size(), "is", "are"), list_of(concerned));
    std::erase(c.behind, c.module);
    if (!joint && !c.behind.empty()) behind = fmt::format("; behind it are out of reach: {}", list_of(c.behind));
    Finding& f = add(joint ? Seen::kJointPassesNothing : Seen::kModuleNotFound, c.module, fmt::arg("patch", p.patch),
                     fmt::arg("joint", joint ? joint_text(design_, c.module, c.other) : ""), fmt::arg("behind", behind),
                     fmt::arg("meanwhile", meanwhile + held));
    if (!joint) f.text = fmt::format("patch {}: {}", p.patch, f.text);
    f.other = c.other;
    f.behind = c.behind;
  }
  explained_by_this(missing);
}

// Bad modules have findings of their own: one with a fault is repaired first and has other rest values afterwards.
void Diagnosis::examine_rest() {
  if (rest_.empty()) return;
  design::OffRest all;
  std::vector<layout::ModuleId> modules;
  for (const PatchState& p : patches_) {
    for (std::size_t row = 0; p.usable && row < std::min(p.now.count, p.image.module_count); ++row) {
      const layout::ModuleId module = p.module(row);
      if (bad_.contains(module)) continue;
      const wire::ModuleTaxels& now = p.now.modules[row];
      const auto& rest = rest_.at(static_cast<std::size_t>(module));
      const double warming = pads_change_counts(now, rest);
      int off = 0;
      for (std::size_t t = 0; t < layout::kTaxelsPerModule; ++t) {
        if (!layout::measures_pressure(t) || !now.is_valid(t)) continue;
        off += std::abs(now.value[t] - rest[t] - warming) >= kMaxRestError_counts ? 1 : 0;
      }
      if (off > 0) modules.push_back(module);
      all.taxels += off;
    }
  }
  if (modules.empty()) return;
  std::ranges::sort(modules);
  all.modules = design::numbers_of(design_, modules);
  // The modules themselves work, so modules_ok includes them.
  Finding f = finding(Seen::kOffRest, fmt::arg("sentence", sentence(all)));
  f.module = modules.front();
  f.behind.assign(modules.begin() + 1, modules.end());
  add(std::move(f));
}

}  // namespace triskin::diagnose
