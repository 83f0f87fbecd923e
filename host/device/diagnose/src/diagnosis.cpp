// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

#include "cover_place.hpp"
#include "triskin/base/counted.hpp"
#include "triskin/design/straps.hpp"
#include "triskin/session/adopted_modules.hpp"
#include "verification.hpp"

namespace triskin::diagnose {

using wire::ModuleState;

namespace {

bool is_at_end(std::uint16_t raw) {
  return raw == 0 || raw == 0xFFFF;
}

std::string at(int line, int address) {
  return fmt::format("L{}, {}", line, design::address_strap(address));
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
  examine_drift();
  for (const TouchOutcome& t : touches_) examine_touch(t);
  examine_rest();
  result.earlier = examine_earlier();
  result.modules_ok = result.modules - static_cast<int>(bad_.size());
  std::ranges::stable_sort(findings_, {}, [](const Finding& f) { return likelihood_rank(f.kind); });
  result.findings.insert(result.findings.end(), findings_.begin(), findings_.end());
}

std::string Diagnosis::where(layout::ModuleId module) const {
  const auto& w = wiring_[static_cast<std::size_t>(module)];
  return fmt::format("module {} (patch {}, {})", number(module), w.patch, at(w.routed.line, w.routed.address));
}

Finding& Diagnosis::add(Finding f) {
  if (f.module >= 0) f.place = place_on_cover(design_, f.module);
  return findings_.emplace_back(std::move(f));
}

const TouchOutcome* Diagnosis::touch_of(layout::ModuleId module) const {
  const auto found = std::ranges::find(touches_, module, &TouchOutcome::module);
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
    add(Seen::kReadByNeighbour, modules.front(), fmt::arg("patch", patches.first), fmt::arg("other", patches.second),
        fmt::arg("list", list_of(modules)))
        .behind.assign(modules.begin() + 1, modules.end());
    explained_by_this(modules);
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
    const auto recoveries = p.line_states.lines[k].recoveries;
    if (!held && (recoveries == 0 || left_out_.contains(p.patch))) continue;
    std::string what =
        held ? "is held low" : fmt::format("was held low and freed by clock pulses {}", counted(recoveries, "time"));
    // The controller leaves out what holds a line if it can, and looks for a way round again and again if it cannot:
    // meanwhile the other lines have gaps, too.
    if (held && p.topology.switched) {
      what +=
          fmt::format(" at the cable or at module {}, because what is behind would be left out", number(p.module(0)));
      for (std::size_t row = 0; row < p.image.module_count; ++row) explained_by_this(std::array{p.module(row)});
    }
    add(Seen::kLineHeld, p.patch, fmt::arg("line", l), fmt::arg("what", what), fmt::arg("list", list_of(modules)))
        .line = l;
    if (held) explained_by_this(modules);
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
        add(Seen::kOtherChip, module);
        break;
      case ModuleState::kDuplicate:
        doubled.push_back(row);
        break;
      case ModuleState::kUnknown:
        if (!explained_.insert(module).second) break;
        add(Seen::kNothingRead, module);
        break;
      case ModuleState::kSaturated:
      case ModuleState::kFrozen:
      case ModuleState::kOk:
        examine_taxels(p, row);
        break;
      case ModuleState::kLostConfiguration:
      case ModuleState::kLineStuck:
        break;  // These states are reported by examine_history() and examine_lines().
    }
  }
  // If two chips answer at one address, one of them is the absent module that explains most.
  for (const std::size_t row : doubled) {
    const layout::ModuleRow& r = p.image.modules[row];
    const layout::ModuleId module = p.module(row);
    explained_.insert(module);
    if (absent.empty())
      add(Seen::kTwoChips, module);
    else
      add_at(Seen::kPlaceShared, p, take_likeliest(p, absent, {r.line, r.address}), {r.line, r.address}, module);
  }
  examine_absent(p, absent);
}

void Diagnosis::examine_taxels(const PatchState& p, std::size_t row) {
  constexpr int kManyTaxels = 6;  // If this many taxels of a module are at their ends, they count as one fault.
  const layout::ModuleId module = p.module(row);
  const wire::ModuleTaxels& now = p.now.modules[row];
  int at_end = 0, valid = 0;
  for (std::size_t t = 0; t < now.value.size(); ++t) {
    at_end += !now.is_valid(t) && is_at_end(now.value[t]) ? 1 : 0;
    valid += now.is_valid(t) ? 1 : 0;
  }
  if (valid == 0 && at_end == 0) return;  // Nothing was read at this moment: a taxel is frozen while others change.
  if (at_end >= kManyTaxels) {
    explained_.insert(module);
    add(Seen::kManyAtEnd, module, fmt::arg("taxels", counted(at_end, "taxel")),
        fmt::arg("are", agreeing(at_end, "is", "are")));
    return;
  }
  for (layout::TaxelIndex t; t < layout::kTaxelsPerModule; ++t) {
    const auto k = static_cast<std::size_t>(t);
    if (!now.is_valid(k))
      add(is_at_end(now.value[k]) ? Seen::kAtEnd : Seen::kOneValue, module, fmt::arg("taxel", t)).taxel = t;
  }
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
// straps that differ, and one wrong strap is likelier than several.
double Diagnosis::cost_of_taking(const PatchState& p, const std::vector<std::size_t>& rows, std::size_t row,
                                 const Place& place) const {
  constexpr double kStrap = 0.3;
  Modules left;
  for (const std::size_t r : rows) {
    if (r != row) left.insert(p.module(r));
  }
  const layout::ModuleRow& meant = p.image.modules[row];
  const int straps = std::popcount(static_cast<unsigned>(place.line ^ meant.line)) +
                     std::popcount(static_cast<unsigned>(place.address ^ meant.address));
  return static_cast<double>(branches(p, left).size()) + kStrap * straps;
}

std::size_t Diagnosis::take_likeliest(const PatchState& p, std::vector<std::size_t>& rows, const Place& place) const {
  const auto best =
      std::ranges::min_element(rows, {}, [&](std::size_t row) { return cost_of_taking(p, rows, row, place); });
  const std::size_t row = *best;
  rows.erase(best);
  return row;
}

// The module of `row` sits at `place`, maybe together with another one.
void Diagnosis::add_at(Seen seen, const PatchState& p, std::size_t row, const Place& place, layout::ModuleId other) {
  const layout::ModuleRow& meant = p.image.modules[row];
  Finding& f = add(seen, p.module(row), fmt::arg("place", at(place.line, place.address)),
                   fmt::arg("other", number(other)), fmt::arg("meant", at(meant.line, meant.address)));
  f.other = other;
  f.line = place.line;
  f.address = place.address;
  explained_.insert(f.module);
  if (other >= 0) bad_.insert(other);
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
    if (touch == nullptr || !touch->whole || touch->answered < 0 || touch->answered == module) {
      open.push_back(row);
      continue;
    }
    const auto& o = wiring_[static_cast<std::size_t>(touch->answered)].routed;
    add_at(Seen::kPlaceShared, p, row, {o.line, o.address}, touch->answered);
  }
  // Chips answer where the design has none: the cheapest explanation first.
  std::vector<Place> elsewhere = unexpected(p);
  while (!elsewhere.empty() && !open.empty()) {
    const auto place = std::ranges::min_element(elsewhere, {}, [&](const Place& candidate) {
      double least = std::numeric_limits<double>::max();
      for (const std::size_t row : open) least = std::min(least, cost_of_taking(p, open, row, candidate));
      return least;
    });
    add_at(Seen::kOtherPlace, p, take_likeliest(p, open, *place), *place);
    elsewhere.erase(place);
  }
  Modules silent;
  for (const std::size_t row : open) silent.insert(p.module(row));
  // If a neighbour reads a module, it must be switched, even though the chain of this patch does not answer.
  if (std::ranges::any_of(silent, [&](layout::ModuleId m) { return adopter_.contains(m); })) {
    examine_missing(p, silent);
    silent.clear();
  }
  explain(p, std::move(silent),
          {Seen::kLineSilent, Seen::kSupplySilent, Seen::kJointSilent,
           touches_.empty() ? Seen::kNoChip : Seen::kNoChipAfterTouch});
  for (const Place& place : elsewhere) {
    Finding& f = add(Seen::kStrayChip, p.patch, fmt::arg("place", at(place.line, place.address)));
    f.line = place.line;
    f.address = place.address;
  }
}

// Nothing touches the skin at the beginning and at the end. The pads that feel no finger drift as well, so `live` takes
// it for warmth; but warmth reaches more than one module.
void Diagnosis::examine_drift() {
  struct Change {
    layout::ModuleId module;
    double counts = 0.0, seconds = 0.0;
    bool alike = true;  // of all taxels
  };
  std::vector<Change> changes;
  for (const PatchState& p : patches_) {
    for (std::size_t row = 0; p.usable && row < std::min({p.first.count, p.now.count, p.image.module_count}); ++row) {
      const wire::ModuleTaxels &first = p.first.modules[row], &now = p.now.modules[row];
      std::vector<double> counts;
      for (std::size_t t = 0; t < layout::kTaxelsPerModule; ++t) {
        if (first.is_valid(t) && now.is_valid(t))
          counts.push_back(static_cast<double>(now.value[t]) - static_cast<double>(first.value[t]));
      }
      if (counts.empty() || bad_.contains(p.module(row)) || p.now.time_us <= p.first.time_us) continue;
      const auto [low, high] = std::ranges::minmax(counts);
      changes.push_back({p.module(row), (low + high) / 2.0, static_cast<double>(p.now.time_us - p.first.time_us) * 1e-6,
                         high - low <= std::max(std::abs(low + high) / 2.0, kMaxRestError_counts)});
    }
  }
  if (changes.size() < 3) return;  // Of two modules nobody knows which one drifts.
  const auto middle = changes.begin() + static_cast<std::ptrdiff_t>(changes.size() / 2);
  std::ranges::nth_element(changes, middle, {}, &Change::counts);
  const double common = middle->counts;
  std::ranges::sort(changes, {}, &Change::module);
  for (const Change& c : changes) {
    if (!c.alike || std::abs(c.counts - common) < kMaxRestError_counts) continue;
    add(Seen::kDrifts, c.module, fmt::arg("rate", std::lround((c.counts - common) / c.seconds)));
  }
}

}  // namespace triskin::diagnose
