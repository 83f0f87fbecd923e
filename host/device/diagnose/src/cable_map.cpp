// SPDX-License-Identifier: GPL-3.0-or-later
#include "cable_map.hpp"

#include <algorithm>
#include <numeric>
#include <utility>

namespace triskin::diagnose {

using wire::ModuleState;

namespace {

constexpr int kMinExplained = 3;  // Fewer modules could just as well be exchanged or strapped wrongly.

std::size_t index(int n) {
  return static_cast<std::size_t>(n);
}

// Returns the row of the table that a controller samples at a place.
std::optional<std::size_t> row_at(const PatchState& p, int line, int address) {
  for (std::size_t row = 0; row < p.image.module_count; ++row) {
    if (p.image.modules[row].line == line && p.image.modules[row].address == address) return row;
  }
  return std::nullopt;
}

// Derives a state from the discovery for a place that no row samples.
ModuleState state_of(const wire::LineReport& line, int address) {
  if (line.stuck) return ModuleState::kLineStuck;
  if ((line.answers >> address & 1) == 0) return ModuleState::kAbsent;
  return (line.wrong_id >> address & 1) != 0 ? ModuleState::kWrongId : ModuleState::kOk;
}

void read_row(PatchState& p, std::size_t row, const PatchState& from, const Site& seen) {
  if (const auto other = row_at(from, seen.line, seen.address)) {
    p.states.state[row] = from.states.state[*other];
    p.now.modules[row] = from.now.modules[*other];
    p.first.modules[row] = from.first.modules[*other];
    p.rest.modules[row] = from.rest.modules[*other];
    return;
  }
  p.states.state[row] = state_of(from.lines[index(seen.line)], seen.address);
  p.now.modules[row].valid = layout::kAllTaxels;
  p.first.modules[row] = p.rest.modules[row] = p.now.modules[row];
}

// Returns the faults of the rows of `from`, renumbered to rows of `p`.
wire::FaultList faults_of(const PatchState& p, const PatchState& from, const CableMap& map,
                          const wire::FaultList& faults) {
  wire::FaultList mine;
  for (wire::FaultRecord f : faults.faults()) {
    if (f.code.row >= from.image.module_count) continue;
    const layout::ModuleRow& r = from.image.modules[f.code.row];
    const Site meant = map.meant_by({from.patch, r.line, r.address});
    const auto row = meant.patch == p.patch ? row_at(p, meant.line, meant.address) : std::nullopt;
    if (!row) continue;
    f.code.row = static_cast<std::uint8_t>(*row);
    mine.add(f);
  }
  return mine;
}

PatchState patch_through(const CableMap& map, const PatchState& own, const std::vector<PatchState>& patches) {
  PatchState p = own;
  const PatchState& from = patches[index(map.seen_at({own.patch, 0, 0}).patch)];
  for (int l = 0; l < layout::kLines; ++l) {
    const auto seen = index(map.seen_at({own.patch, l, 0}).line);
    p.lines[index(l)] = from.lines[seen];
    p.line_states.lines[index(l)] = from.line_states.lines[seen];
  }
  for (std::size_t row = 0; row < p.image.module_count; ++row) {
    const layout::ModuleRow& r = p.image.modules[row];
    read_row(p, row, from, map.seen_at({own.patch, r.line, r.address}));
  }
  p.faults = faults_of(p, from, map, from.faults);
  p.earlier = faults_of(p, from, map, from.earlier);
  return p;
}

bool exchangeable(const PatchState& p) {
  return p.usable && !p.topology.switched;
}

// Counts the modules that are not where they should be, and the chips where none should be.
int wrong_places(const Observation& o) {
  int wrong = 0;
  for (const PatchState& p : o.patches) {
    if (!p.usable) continue;
    for (std::size_t row = 0; row < p.image.module_count; ++row)
      wrong += p.states.state[row] == ModuleState::kAbsent ? 1 : 0;
    for (int l = 0; l < layout::kLines; ++l) {
      for (int a = 0; a < layout::kAddressesPerLine; ++a)
        wrong += (p.lines[index(l)].answers >> a & 1) != 0 && !row_at(p, l, a) ? 1 : 0;
    }
  }
  for (const TouchOutcome& t : o.touches) wrong += t.whole && t.answered != t.module ? 1 : 0;
  return wrong;
}

std::vector<CableExplanation> candidates(const std::vector<PatchState>& patches) {
  std::vector<CableExplanation> all;
  for (const PatchState& p : patches) {
    if (!exchangeable(p)) continue;
    for (const PatchState& q : patches) {
      if (exchangeable(q) && q.patch > p.patch) all.push_back({p.patch, q.patch});
    }
    for (int a = 0; a < layout::kLines; ++a) {
      for (int b = a + 1; b < layout::kLines; ++b) all.push_back({p.patch, layout::PatchIndex::none(), a, b});
    }
  }
  return all;
}

void apply(CableMap& map, const CableExplanation& e) {
  if (e.other >= 0)
    map.exchange_patches(e.patch, e.other);
  else
    map.exchange_lines(e.patch, e.line_a, e.line_b);
}

}  // namespace

CableMap::CableMap(std::size_t patches) : controller_(patches), line_(patches, {0, 1, 2, 3}) {
  std::iota(controller_.begin(), controller_.end(), layout::PatchIndex{});
}

void CableMap::exchange_patches(layout::PatchIndex p, layout::PatchIndex q) {
  std::swap(controller_[index(p)], controller_[index(q)]);
}

void CableMap::exchange_lines(layout::PatchIndex p, int a, int b) {
  std::swap(line_[index(p)][index(a)], line_[index(p)][index(b)]);
}

Site CableMap::seen_at(const Site& meant) const {
  return {controller_[index(meant.patch)], line_[index(meant.patch)][index(meant.line)], meant.address};
}

Site CableMap::meant_by(const Site& seen) const {
  const layout::PatchIndex patch{std::ranges::find(controller_, seen.patch) - controller_.begin()};
  const auto& lines = line_[index(patch)];
  return {patch, static_cast<int>(std::ranges::find(lines, seen.line) - lines.begin()), seen.address};
}

Observation read_through(const CableMap& map, const design::Design& design, const std::vector<PatchState>& patches,
                         const std::vector<TouchOutcome>& touches) {
  Observation o;
  for (const PatchState& p : patches) o.patches.push_back(p.usable ? patch_through(map, p, patches) : p);
  const auto wiring = design::wiring_of(design);
  const auto place_of = [&](layout::ModuleId module) {
    const auto& w = wiring[index(module)];
    return Site{w.patch, w.routed.line, w.routed.address};
  };
  for (TouchOutcome t : touches) {
    const Site own = map.seen_at(place_of(t.module));
    if (t.answered >= 0) {
      const Site meant = map.meant_by(place_of(t.answered));
      const auto row = row_at(patches[index(meant.patch)], meant.line, meant.address);
      t.answered = row ? patches[index(meant.patch)].module(*row) : layout::ModuleId::none();
    }
    // If no row samples the place where the module is read, the touch shows nothing.
    if (!row_at(patches[index(own.patch)], own.line, own.address) && t.answered != t.module) continue;
    o.touches.push_back(t);
  }
  return o;
}

std::vector<CableExplanation> explain_cables(CableMap& map, const design::Design& design,
                                             const std::vector<PatchState>& patches,
                                             const std::vector<TouchOutcome>& touches) {
  std::vector<CableExplanation> found;
  int wrong = wrong_places(read_through(map, design, patches, touches));
  const auto tries = wrong >= kMinExplained ? candidates(patches) : std::vector<CableExplanation>{};
  while (wrong >= kMinExplained) {
    CableExplanation best;
    for (CableExplanation c : tries) {
      CableMap guess = map;
      apply(guess, c);
      c.modules = wrong - wrong_places(read_through(guess, design, patches, touches));
      if (c.modules > best.modules) best = c;
    }
    if (best.modules < kMinExplained) break;
    apply(map, best);
    wrong -= best.modules;
    found.push_back(best);
  }
  return found;
}

}  // namespace triskin::diagnose
