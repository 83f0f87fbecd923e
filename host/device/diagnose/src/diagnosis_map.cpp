// SPDX-License-Identifier: GPL-3.0-or-later
// Finds out which module is where: cables, order, rotation.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

#include "cable_map.hpp"
#include "triskin/base/counted.hpp"
#include "verification.hpp"

namespace triskin::diagnose {

void Diagnosis::examine_cables() {
  CableMap map(patches_.size());
  const auto concern = [&](layout::PatchIndex patch, int line) {
    for (const auto& m : design_.patches[static_cast<std::size_t>(patch)].modules) {
      if (line < 0 || m.line == line) bad_.emplace(m.node);
    }
  };
  for (const CableExplanation& e : explain_cables(map, design_, patches_, touches_)) {
    if (e.other < 0) {
      add(Seen::kLinesExchanged, e.patch, fmt::arg("line", e.line_a), fmt::arg("other", e.line_b)).line = e.line_a;
      concern(e.patch, e.line_a);
      concern(e.patch, e.line_b);
    } else {
      add(Seen::kCablesExchanged, e.patch, fmt::arg("other", e.other));
      concern(e.patch, -1);
      concern(e.other, -1);
    }
  }
  Observation o = read_through(map, design_, patches_, touches_);
  patches_ = std::move(o.patches);
  touches_ = std::move(o.touches);
}

// Most modules answer at other places, and these form the mirrored or turned shape of the modules: those that answered
// are as far from each other as those that were pressed.
void Diagnosis::examine_mirrored(const PatchState& p) {
  constexpr double kSameDistance_mm = 2.0;  // The tolerance allows for patches that are bent on a curved cover.
  const auto patch_of = [&](layout::ModuleId module) { return wiring_[static_cast<std::size_t>(module)].patch; };
  std::vector<const TouchOutcome*> whole;  // answered within the patch, with the finger at the centre
  for (const TouchOutcome& t : touches_) {
    if (t.whole && t.answered >= 0 && patch_of(t.module) == p.patch && patch_of(t.answered) == p.patch)
      whole.push_back(&t);
  }
  const auto moved = static_cast<std::size_t>(
      std::ranges::count_if(whole, [](const TouchOutcome* t) { return t->answered != t->module; }));
  if (moved < 4 || 5 * moved < 3 * whole.size()) return;
  const auto centre = [&](layout::ModuleId m) {
    const auto& c = design_.layout.modules[static_cast<std::size_t>(m)].corner_mm;
    return design::Vec3((c[0] + c[1] + c[2]) / 3.0);
  };
  const auto distance_mm = [&](layout::ModuleId a, layout::ModuleId b) { return (centre(a) - centre(b)).norm(); };
  for (const TouchOutcome* a : whole) {
    for (const TouchOutcome* b : whole) {
      const double change_mm = distance_mm(a->module, b->module) - distance_mm(a->answered, b->answered);
      if (std::abs(change_mm) > kSameDistance_mm) return;
    }
  }
  add(Seen::kMirrored, p.patch, fmt::arg("moved", moved), fmt::arg("modules", counted(whole.size(), "module")),
      fmt::arg("answer", agreeing(moved, "answers", "answer")));
  for (const TouchOutcome* t : whole) explained_by_this(std::array{t->module});
}

// Returns modules that answer for each other in a ring: pressing one changes the next, and pressing the last changes
// the first. Empty if there is no ring.
std::vector<layout::ModuleId> Diagnosis::ring_from(layout::ModuleId module) const {
  std::vector<layout::ModuleId> ring{module};
  while (true) {
    const TouchOutcome* const t = touch_of(ring.back());
    if (t == nullptr || !t->whole || t->answered < 0) return {};
    if (t->answered == module) return ring;
    if (std::ranges::find(ring, t->answered) != ring.end()) return {};
    ring.push_back(t->answered);
  }
}

void Diagnosis::examine_touch(const TouchOutcome& t) {
  if (t.answered == t.module) {
    for (layout::TaxelIndex taxel; taxel < layout::kTaxelsPerModule; ++taxel) {
      const bool reported =
          std::ranges::any_of(findings_, [&](const Finding& f) { return f.module == t.module && f.taxel == taxel; });
      if ((t.silent_taxels >> taxel & 1) == 0 || reported) continue;
      add(Seen::kNotUnderFinger, t.module, fmt::arg("taxel", taxel)).taxel = taxel;
    }
    if (t.turned == 0 || explained_.contains(t.module)) return;
    add(Seen::kTurned, t.module, fmt::arg("degrees", 120 * t.turned));
    return;
  }
  if (explained_.contains(t.module)) return;  // The module is absent, on a stuck line, or the other half of a swap.
  if (t.answered < 0 || !t.whole) {           // A neighbour that only feels the rim of the finger is no answer.
    add(Seen::kNoResponse, t.module);
    return;
  }
  const std::vector<layout::ModuleId> ring = ring_from(t.module);
  // A switched module that is out of reach now shows what it had when it was last read.
  const PatchState& its = patches_[static_cast<std::size_t>(wiring_[static_cast<std::size_t>(t.answered)].patch)];
  if (ring.empty() && its.topology.switched && explained_.contains(t.answered)) return;
  const Seen seen = ring.size() > 2 ? Seen::kRing : ring.size() == 2 ? Seen::kPairSwapped : Seen::kOtherAnswered;
  add(seen, t.module, fmt::arg("patch", wiring_[static_cast<std::size_t>(t.module)].patch),
      fmt::arg("other", where(t.answered)), fmt::arg("list", list_of(ring)))
      .other = t.answered;
  explained_by_this(ring);
}

}  // namespace triskin::diagnose
