// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <bit>
#include <limits>

#include "cover_place.hpp"
#include "triskin/base/counted.hpp"
#include "triskin/design/straps.hpp"
#include "triskin/diagnose/topology.hpp"
#include "triskin/session/adopted_modules.hpp"
#include "verification.hpp"

namespace triskin::diagnose {

using wire::ModuleState;

namespace {

constexpr int kManyTaxels = 6;  // If this many taxels of a module are at their ends, they count as one fault.

// One cause for many modules is likelier than a cause for each; a wrong map is likelier than dead hardware.
int likelihood_rank(FindingKind kind) {
  static constexpr std::array kOrder{
      FindingKind::kWrongPatch,      FindingKind::kSwappedLines,      FindingKind::kMirroredPatch,
      FindingKind::kStuckLine,       FindingKind::kMissingJoint,      FindingKind::kSaggingSupply,
      FindingKind::kLooseJoint,      FindingKind::kWrongOrder,        FindingKind::kSwappedModules,
      FindingKind::kWrongAddress,    FindingKind::kDuplicateAddress,  FindingKind::kRotatedModule,
      FindingKind::kWrongId,         FindingKind::kAbsentModule,      FindingKind::kAdoptedModule,
      FindingKind::kNoTouchResponse, FindingKind::kLostConfiguration, FindingKind::kIntermittentModule,
      FindingKind::kSaturatedTaxel,  FindingKind::kFrozenTaxel,       FindingKind::kTouchedOtherModule,
      FindingKind::kUnexpectedChip,  FindingKind::kStaleRest};
  return static_cast<int>(std::ranges::find(kOrder, kind) - kOrder.begin());
}

constexpr PastFault kWentAway{.together = FindingKind::kLooseJoint,
                              .seen_together = "went and came back together:",
                              .remedy_together = "look for a loose contact there",
                              .alone = FindingKind::kIntermittentModule,
                              .seen_alone = "answers now, but did not for some time",
                              .remedy_alone = "check its joints for a loose contact"};
constexpr PastFault kLostSupply{
    .together = FindingKind::kSaggingSupply,
    .seen_together = "lost their configuration together:",
    .remedy_together = "measure the supply there: it sags along the tree; shorten the way or feed it from another side",
    .alone = FindingKind::kLostConfiguration,
    .seen_alone = "its chip lost its configuration and was set up again",
    .remedy_alone = "check the supply of the module: its power dips"};

bool is_at_end(std::uint16_t raw) {
  return raw == 0 || raw == 0xFFFF;
}

}  // namespace

Diagnosis::Diagnosis(const design::Design& design, std::vector<PatchState> patches, std::vector<TouchOutcome> touches,
                     const design::RestValues& rest)
    : design_(design),
      patches_(std::move(patches)),
      touches_(std::move(touches)),
      rest_(rest),
      wiring_(design::wiring_of(design)) {}

void Diagnosis::run(VerifyResult& result) {
  examine_cables();
  note_adopted();
  for (const PatchState& p : patches_) examine_patch(p);
  examine_adoption();
  for (const TouchOutcome& t : touches_) examine_touch(t);
  examine_rest();
  result.earlier = examine_earlier();
  result.modules_ok = result.modules - static_cast<int>(bad_.size());
  std::ranges::stable_sort(findings_, {}, [](const Finding& f) { return likelihood_rank(f.kind); });
  result.findings.insert(result.findings.end(), findings_.begin(), findings_.end());
}

std::string Diagnosis::at(int line, int address) {
  return fmt::format("L{}, {}", line, design::address_strap(address));
}

std::string Diagnosis::where(layout::ModuleId module) const {
  const auto& w = wiring_[static_cast<std::size_t>(module)];
  return fmt::format("module {} (patch {}, {})", module, w.patch, at(w.routed.line, w.routed.address));
}

Finding& Diagnosis::add(FindingKind kind, layout::ModuleId module, layout::PatchIndex patch, std::string text,
                        std::string remedy) {
  Finding f;
  f.kind = kind;
  f.module = module;
  f.patch = patch;
  f.text = std::move(text);
  f.remedy = std::move(remedy);
  if (module >= 0) {
    bad_.insert(module);
    f.place = place_on_cover(design_, module);
  }
  return findings_.emplace_back(std::move(f));
}

const TouchOutcome* Diagnosis::touch_of(layout::ModuleId module) const {
  const auto found = std::ranges::find_if(touches_, [&](const TouchOutcome& t) { return t.module == module; });
  return found == touches_.end() ? nullptr : &*found;
}

// Modules that a neighbour reads are alive; only the path from their own controller is broken.
void Diagnosis::note_adopted() {
  const session::ModuleEnds ends = design::module_ends(design_);
  for (const PatchState& p : patches_) {
    std::vector<layout::ModuleId> rows;
    for (std::size_t row = 0; row < p.image.module_count; ++row) rows.push_back(p.module(row));
    for (const layout::ModuleId m : session::adopted_modules(ends, rows, p.adoption)) {
      if (m >= 0) adopter_.emplace(m, p.patch);
    }
  }
}

// Reports the adopted modules for which no break was found, together for each pair of patches.
void Diagnosis::examine_adoption() {
  std::map<std::pair<layout::PatchIndex, layout::PatchIndex>, std::vector<layout::ModuleId>> left;
  for (const auto& [module, by] : adopter_) {
    if (!explained_.contains(module)) left[{wiring_[static_cast<std::size_t>(module)].patch, by}].push_back(module);
  }
  for (const auto& [patches, modules] : left) {
    Finding& f = add(FindingKind::kAdoptedModule, modules.front(), patches.first,
                     fmt::format("patch {}: modules out of reach of its controller, which that of patch {} reads: {}",
                                 patches.first, patches.second, fmt::join(modules, ", ")),
                     "repair the modules or joints between them and their own controller; they are handed back then");
    f.behind.assign(modules.begin() + 1, modules.end());
    bad_.insert(modules.begin(), modules.end());
    explained_.insert(modules.begin(), modules.end());
  }
}

void Diagnosis::examine_patch(const PatchState& p) {
  if (!p.usable) {
    for (std::size_t row = 0; row < p.image.module_count; ++row) bad_.insert(p.module(row));
    return;
  }
  for (const auto& m : design_.patches[static_cast<std::size_t>(p.patch)].modules) {
    if (!p.reads(layout::ModuleId{m.node})) bad_.emplace(m.node);
  }
  examine_topology(p);
  examine_lines(p);
  examine_history(p);
  examine_modules(p);
  examine_mirrored(p);
}

// With switched modules, the chain tells more than a silent chip does.
void Diagnosis::examine_topology(const PatchState& p) {
  if (!p.topology.switched) return;
  const TopologyMatch match = match_topology(p.topology, design_, p.patch);
  const TopologyMatch best = identify_patch(p.topology, design_).front();
  const bool other = best.patch != p.patch && best.differences.size() + 2 < match.differences.size();
  if (other || match.another_patch())
    return add_wrong_patch(p,
                           other && !best.another_patch()
                               ? fmt::format("its controller hangs on the modules of patch {}", best.patch)
                               : fmt::format("the {} found are not this patch", counted(p.topology.count, "module")));
  std::set<layout::ModuleId> missing;
  for (const TopologyDifference& d : match.differences) {
    if (d.kind == FindingKind::kMissingModule)
      missing.insert(d.module);
    else
      add_difference(p, d);
  }
  examine_missing(p, missing);
}

void Diagnosis::add_wrong_patch(const PatchState& p, const std::string& what) {
  add(FindingKind::kWrongPatch, layout::ModuleId::none(), p.patch, fmt::format("patch {}: {}", p.patch, what),
      "exchange the cables of the controllers, or compare the patch with the assembly sheet");
  for (const auto& m : design_.patches[static_cast<std::size_t>(p.patch)].modules) {
    explained_.emplace(m.node);
    bad_.emplace(m.node);
  }
}

void Diagnosis::add_difference(const PatchState& p, const TopologyDifference& d) {
  // The modules of the joint may still be readable.
  const bool joint = d.kind == FindingKind::kMissingJoint || d.kind == FindingKind::kExtraJoint;
  Finding& f = add(d.kind, joint ? layout::ModuleId::none() : d.module, p.patch,
                   fmt::format("patch {}: {}", p.patch, d.text), d.remedy);
  f.module = d.module;
  f.other = d.other;
  if (joint) return;
  explained_.insert(d.module);
  if (d.other >= 0) explained_.insert(d.other);
}

void Diagnosis::examine_lines(const PatchState& p) {
  for (int l = 0; l < layout::kLines; ++l) {
    const auto k = static_cast<std::size_t>(l);
    std::vector<layout::ModuleId> modules;
    bool held = p.lines[k].stuck;
    for (std::size_t row = 0; row < p.image.module_count; ++row) {
      if (p.image.modules[row].line != l) continue;
      modules.push_back(p.module(row));
      held = held || p.states.state[row] == ModuleState::kLineStuck;
    }
    if (!held && p.line_states.lines[k].recoveries == 0) continue;
    const std::string what = held ? "is held low"
                                  : fmt::format("was held low and freed by clock pulses {}",
                                                counted(p.line_states.lines[k].recoveries, "time"));
    Finding& f = add(
        FindingKind::kStuckLine, layout::ModuleId::none(), p.patch,
        fmt::format("patch {}, line L{}: SDA or SCL {}; modules on it: {}", p.patch, l, what, fmt::join(modules, ", ")),
        "look for a short of this line; part the joints from the far end on until the line is free");
    f.line = l;
    if (!held) continue;
    bad_.insert(modules.begin(), modules.end());
    explained_.insert(modules.begin(), modules.end());
  }
}

void Diagnosis::examine_modules(const PatchState& p) {
  std::vector<std::size_t> absent, doubled;
  for (std::size_t row = 0; row < p.image.module_count; ++row) {
    const layout::ModuleId module = p.module(row);
    switch (p.states.state[row]) {
      case ModuleState::kAbsent:
        if (p.topology.switched && explained_.contains(module))
          bad_.insert(module);
        else
          absent.push_back(row);
        break;
      case ModuleState::kWrongId:
        explained_.insert(module);
        add(FindingKind::kWrongId, module, p.patch, where(module) + ": a chip answers, but it is no AD7147",
            "look at the part that is soldered there; another device may share the address");
        break;
      case ModuleState::kDuplicate:
        doubled.push_back(row);
        break;
      case ModuleState::kSaturated:
      case ModuleState::kFrozen:
      case ModuleState::kOk:
      case ModuleState::kUnknown:
        examine_taxels(p, row);
        break;
      case ModuleState::kLostConfiguration:
      case ModuleState::kLineStuck:
        break;  // These states are reported by examine_history() and examine_lines().
    }
  }
  examine_doubled(p, absent, doubled);
  examine_absent(p, absent);
}

// If two chips answer at one address, one of them is the absent module that explains most.
void Diagnosis::examine_doubled(const PatchState& p, std::vector<std::size_t>& absent,
                                const std::vector<std::size_t>& doubled) {
  for (const std::size_t row : doubled) {
    const layout::ModuleRow& r = p.image.modules[row];
    const layout::ModuleId module = p.module(row);
    explained_.insert(module);
    if (absent.empty()) {
      add(FindingKind::kDuplicateAddress, module, p.patch, where(module) + ": two chips answer at once",
          "compare the straps of the modules with the assembly sheet");
      continue;
    }
    add_duplicate(p, take_likeliest(p, absent, {r.line, r.address}), module);
  }
}

void Diagnosis::add_duplicate(const PatchState& p, std::size_t row, layout::ModuleId other) {
  const layout::ModuleId module = p.module(row);
  const layout::ModuleRow& r = p.image.modules[row];
  const auto& o = wiring_[static_cast<std::size_t>(other)].routed;
  Finding& f = add(FindingKind::kDuplicateAddress, module, p.patch,
                   fmt::format("{}: nothing answers there; it sits at {} together with module {}", where(module),
                               at(o.line, o.address), other),
                   fmt::format("solder the straps of module {} to {}", module, at(r.line, r.address)));
  f.other = other;
  f.line = o.line;
  f.address = o.address;
  explained_.insert(module);
  bad_.insert(other);
}

// Counts the straps that differ, because one wrong strap is likelier than several.
int Diagnosis::strap_difference(const layout::ModuleRow& row, const Place& place) {
  return std::popcount(static_cast<unsigned>(place.line ^ row.line)) +
         std::popcount(static_cast<unsigned>(place.address ^ row.address));
}

void Diagnosis::examine_taxels(const PatchState& p, std::size_t row) {
  const layout::ModuleId module = p.module(row);
  if (p.states.state[row] == ModuleState::kUnknown) {
    explained_.insert(module);
    add(FindingKind::kAbsentModule, module, p.patch, where(module) + ": the controller has read nothing from it yet",
        "power-cycle the controller and verify again");
    return;
  }
  const wire::ModuleTaxels& now = p.now.modules[row];
  int at_end = 0;
  for (std::size_t t = 0; t < now.value.size(); ++t) at_end += !now.is_valid(t) && is_at_end(now.value[t]) ? 1 : 0;
  if (at_end >= kManyTaxels) {
    explained_.insert(module);
    add(FindingKind::kSaturatedTaxel, module, p.patch,
        fmt::format("{}: {} {} at the end of their range", where(module), counted(at_end, "taxel"),
                    agreeing(at_end, "is", "are")),
        "look for a short of the shield or of the converter's reference; else replace the module");
    return;
  }
  for (std::size_t t = 0; t < now.value.size(); ++t) {
    if (!now.is_valid(t)) add_bad_taxel(module, p.patch, layout::TaxelIndex{t}, is_at_end(now.value[t]));
  }
}

void Diagnosis::add_bad_taxel(layout::ModuleId module, layout::PatchIndex patch, layout::TaxelIndex taxel,
                              bool at_end) {
  Finding& f = at_end ? add(FindingKind::kSaturatedTaxel, module, patch,
                            fmt::format("{}: taxel {} is at the end of its range", where(module), taxel),
                            "look for a short between the pad and its neighbours or the shield")
                      : add(FindingKind::kFrozenTaxel, module, patch,
                            fmt::format("{}: taxel {} keeps one value while the others change", where(module), taxel),
                            "look for a broken trace to the pad");
  f.taxel = taxel;
}

std::vector<Diagnosis::Place> Diagnosis::unexpected(const PatchState& p) const {
  std::vector<Place> places;
  for (int l = 0; l < layout::kLines; ++l) {
    for (int a = 0; a < layout::kAddressesPerLine; ++a) {
      if ((p.lines[static_cast<std::size_t>(l)].answers >> a & 1) == 0) continue;
      const bool in_table =
          std::ranges::any_of(p.image.rows(), [&](const auto& row) { return row.line == l && row.address == a; });
      const bool adopted_module = p.adopted_places.test(static_cast<std::size_t>(layout::kAddressesPerLine * l + a));
      if (!in_table && !adopted_module) places.push_back({l, a});
    }
  }
  return places;
}

// Returns the cost of the facts that remain unexplained if the module of `row` is at `place`: causes count more than
// straps that differ.
double Diagnosis::cost_of_taking(const PatchState& p, const std::vector<std::size_t>& rows, std::size_t row,
                                 const Place& place) const {
  constexpr double kStrap = 0.3;
  std::set<layout::ModuleId> left;
  for (const std::size_t r : rows) {
    if (r != row) left.insert(p.module(r));
  }
  return static_cast<double>(branches(p, left).size()) + kStrap * strap_difference(p.image.modules[row], place);
}

std::size_t Diagnosis::take_likeliest(const PatchState& p, std::vector<std::size_t>& rows, const Place& place) const {
  const auto best =
      std::ranges::min_element(rows, {}, [&](std::size_t row) { return cost_of_taking(p, rows, row, place); });
  const std::size_t row = *best;
  rows.erase(best);
  return row;
}

void Diagnosis::add_wrong_address(const PatchState& p, std::size_t row, const Place& place) {
  const layout::ModuleId module = p.module(row);
  const layout::ModuleRow& r = p.image.modules[row];
  Finding& f = add(FindingKind::kWrongAddress, module, p.patch,
                   fmt::format("{}: nothing answers there, but a chip answers at {}, where the design has none",
                               where(module), at(place.line, place.address)),
                   fmt::format("solder the straps of module {} to {}", module, at(r.line, r.address)));
  f.line = place.line;
  f.address = place.address;
}

// Examines modules that do not answer where they should: they share the place of another one, are somewhere else, are
// behind a broken joint, or are dead.
void Diagnosis::examine_absent(const PatchState& p, const std::vector<std::size_t>& rows) {
  std::vector<std::size_t> open;
  for (const std::size_t row : rows) {
    const layout::ModuleId module = p.module(row);
    explained_.insert(module);
    const TouchOutcome* touch = touch_of(module);
    // A neighbour that only feels the rim of the finger is no answer, because all pads of the pressed module would have
    // changed.
    if (touch != nullptr && touch->whole && touch->answered >= 0 && touch->answered != module)
      add_duplicate(p, row, touch->answered);
    else
      open.push_back(row);
  }
  std::vector<Place> elsewhere = unexpected(p);
  match_elsewhere(p, open, elsewhere);
  std::set<layout::ModuleId> silent;
  for (const std::size_t row : open) silent.insert(p.module(row));
  examine_silent(p, std::move(silent));
  for (const Place& place : elsewhere) {
    Finding& f = add(FindingKind::kUnexpectedChip, layout::ModuleId::none(), p.patch,
                     fmt::format("patch {}: a chip answers at {}, where the design has no module", p.patch,
                                 at(place.line, place.address)),
                     "compare the straps with the assembly sheet");
    f.line = place.line;
    f.address = place.address;
  }
}

// Explains absent modules by chips that answer where the design has none, the cheapest explanation first.
void Diagnosis::match_elsewhere(const PatchState& p, std::vector<std::size_t>& open, std::vector<Place>& elsewhere) {
  while (!elsewhere.empty() && !open.empty()) {
    const auto cost = [&](const Place& place) {
      double least = std::numeric_limits<double>::max();
      for (const std::size_t row : open) least = std::min(least, cost_of_taking(p, open, row, place));
      return least;
    };
    const auto place = std::ranges::min_element(elsewhere, {}, cost);
    add_wrong_address(p, take_likeliest(p, open, *place), *place);
    elsewhere.erase(place);
  }
}

// Reports modules that answer nowhere, those behind one joint together.
void Diagnosis::examine_silent(const PatchState& p, std::set<layout::ModuleId> silent) {
  // If a neighbour reads a module, it must be switched, even though the chain of this patch does not answer.
  if (std::ranges::any_of(silent, [&](layout::ModuleId m) { return adopter_.contains(m); })) {
    examine_missing(p, silent);
    silent.clear();
  }
  add_open_lines(FindingKind::kMissingJoint, p, silent, "no chip answers of");
  for (const Branch& b : branches(p, silent)) {
    if (b.members.size() > 1) {
      add_branch(FindingKind::kMissingJoint, p, b, "no chip answers of " + behind(b),
                 "check this joint or cable first: one break explains all of them");
      continue;
    }
    add(FindingKind::kAbsentModule, b.module, p.patch, where(b.module) + ": no chip answers",
        touches_.empty() ? "check the module, its joint and its straps; verify --touch tells whether it sits on "
                           "another module's address"
                         : "replace the module, or check its joint to the parent");
  }
}

// Makes a finding of a fault that is gone. Present faults have their own findings.
std::optional<Finding> Diagnosis::remembered(const PatchState& p, const wire::FaultRecord& fault) const {
  const auto row = std::size_t{fault.code.row};
  if (row >= p.image.module_count) return std::nullopt;
  const bool is_dip = fault.code.state == ModuleState::kLostConfiguration;
  const bool was_away = fault.code.state == ModuleState::kAbsent || fault.code.state == ModuleState::kWrongId;
  if (!is_dip && (!was_away || p.states.state[row] != ModuleState::kOk)) return std::nullopt;
  const PastFault& past = is_dip ? kLostSupply : kWentAway;
  Finding f;
  f.module = p.module(row);
  f.patch = p.patch;
  f.kind = past.alone;
  f.text = fmt::format("{}: {}", where(f.module), past.seen_alone);
  f.remedy = past.remedy_alone;
  return f;
}

// Reports one cause for all modules behind a joint, and the other modules one by one.
void Diagnosis::examine_history(const PatchState& p) {
  std::set<layout::ModuleId> away, dipped;
  for (const wire::FaultRecord& fault : p.faults.faults()) {
    const auto f = remembered(p, fault);
    if (!f) continue;
    const auto line = static_cast<std::size_t>(wiring_[static_cast<std::size_t>(f->module)].routed.line);
    const bool freed = p.line_states.lines[line].recoveries > 0;  // The line was held low, which has its own finding.
    if (f->kind == FindingKind::kLostConfiguration)
      dipped.insert(f->module);
    else if (!freed)
      away.insert(f->module);
  }
  // Unplugged modules also lost their supply, so that is not reported separately.
  for (const layout::ModuleId m : away) dipped.erase(m);
  examine_dips(p, std::move(away), dipped);
}

void Diagnosis::examine_dips(const PatchState& p, std::set<layout::ModuleId> away,
                             const std::set<layout::ModuleId>& dipped) {
  add_open_lines(FindingKind::kLooseJoint, p, away, kWentAway.seen_together);
  add_branches(p, away, kWentAway);
  add_branches(p, dipped, kLostSupply);
}

void Diagnosis::add_branches(const PatchState& p, const std::set<layout::ModuleId>& modules, const PastFault& fault) {
  for (const Branch& b : branches(p, modules)) {
    if (b.members.size() > 1)
      add_branch(fault.together, p, b, fmt::format("{} {}", fault.seen_together, behind(b)), fault.remedy_together);
    else
      add(fault.alone, b.module, p.patch, fmt::format("{}: {}", where(b.module), fault.seen_alone), fault.remedy_alone);
    explained_.insert(b.members.begin(), b.members.end());
  }
}

std::vector<Finding> Diagnosis::examine_earlier() const {
  std::vector<Finding> earlier;
  for (const PatchState& p : patches_) {
    for (const wire::FaultRecord& fault : p.earlier.faults()) {
      const auto f = remembered(p, fault);
      const auto again = [&](const Finding& other) { return other.kind == f->kind && other.module == f->module; };
      if (f && std::ranges::none_of(findings_, again) && std::ranges::none_of(earlier, again)) earlier.push_back(*f);
    }
  }
  return earlier;
}

}  // namespace triskin::diagnose
