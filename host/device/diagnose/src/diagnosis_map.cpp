// SPDX-License-Identifier: GPL-3.0-or-later
// Finds out which module is where: cables, order, rotation, and modules behind one joint.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "cable_map.hpp"
#include "cover_place.hpp"
#include "triskin/base/counted.hpp"
#include "verification.hpp"

namespace triskin::diagnose {
namespace {

constexpr double kSameDistance_mm = 2.0;  // The tolerance allows for patches that are bent on a curved cover.

}  // namespace

void Diagnosis::add_exchanged(const CableExplanation& e) {
  const auto concern = [&](layout::PatchIndex patch, int line) {
    for (const auto& m : design_.patches[static_cast<std::size_t>(patch)].modules) {
      if (line < 0 || m.line == line) bad_.emplace(m.node);
    }
  };
  if (e.other < 0) {
    add(FindingKind::kSwappedLines, layout::ModuleId::none(), e.patch,
        fmt::format("patch {}: lines {} and {} are exchanged: modules of one answer on the other", e.patch, e.line_a,
                    e.line_b),
        "exchange the two lines at the patch's cable")
        .line = e.line_a;
    concern(e.patch, e.line_a);
    concern(e.patch, e.line_b);
    return;
  }
  add(FindingKind::kWrongPatch, layout::ModuleId::none(), e.patch,
      fmt::format("patches {} and {}: each is plugged into the controller of the other", e.patch, e.other),
      "exchange the cables of the two controllers");
  concern(e.patch, -1);
  concern(e.other, -1);
}

void Diagnosis::examine_cables() {
  CableMap map(patches_.size());
  for (const CableExplanation& e : explain_cables(map, design_, patches_, touches_)) add_exchanged(e);
  Observation o = read_through(map, design_, patches_, touches_);
  patches_ = std::move(o.patches);
  touches_ = std::move(o.touches);
}

namespace {

// Returns for each module of the tree whether it and all modules behind it are among `modules`.
std::map<int, bool> whole_branches(const std::vector<design::RoutedModule>& tree,
                                   const std::set<layout::ModuleId>& modules) {
  std::map<int, bool> whole;
  // Children are listed after their parents, so walking backwards visits them first.
  for (auto m = tree.rbegin(); m != tree.rend(); ++m) {
    const auto [own, fresh] = whole.try_emplace(m->node, true);
    own->second = own->second && modules.contains(layout::ModuleId{m->node});
    if (m->parent >= 0) {
      const auto [parent, first] = whole.try_emplace(m->parent, true);
      parent->second = parent->second && own->second;
    }
  }
  return whole;
}

}  // namespace

// Returns the largest subtrees of the patch that consist of `modules` only; a module whose subtree is incomplete is
// listed alone.
std::vector<Diagnosis::Branch> Diagnosis::branches(const PatchState& p,
                                                   const std::set<layout::ModuleId>& modules) const {
  const auto& tree = design_.patches[static_cast<std::size_t>(p.patch)].modules;
  std::map<int, bool> whole = whole_branches(tree, modules);
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

std::string Diagnosis::behind(const Branch& b) const {
  const std::string from =
      b.parent < 0 ? std::string("the cable of the patch") : joint_text(design_, b.parent, b.module);
  return fmt::format("the {} behind {} ({})", counted(b.members.size(), "module"), from, fmt::join(b.members, ", "));
}

void Diagnosis::add_branch(FindingKind kind, const PatchState& p, const Branch& b, const std::string& text,
                           const std::string& remedy) {
  Finding& f = add(kind, b.module, p.patch, fmt::format("patch {}: {}", p.patch, text), remedy);
  f.other = b.parent;
  f.behind.assign(b.members.begin() + 1, b.members.end());
  bad_.insert(b.members.begin(), b.members.end());
  explained_.insert(b.members.begin(), b.members.end());
}

// Returns the touches of a patch that were answered within it, with the finger at the centre.
std::vector<const TouchOutcome*> Diagnosis::whole_touches(layout::PatchIndex patch) const {
  const auto patch_of = [&](layout::ModuleId module) { return wiring_[static_cast<std::size_t>(module)].patch; };
  std::vector<const TouchOutcome*> whole;
  for (const TouchOutcome& t : touches_) {
    if (t.whole && t.answered >= 0 && patch_of(t.module) == patch && patch_of(t.answered) == patch) whole.push_back(&t);
  }
  return whole;
}

// Returns true if the modules that answered are as far from each other as those that were pressed.
bool Diagnosis::keep_distances(const std::vector<const TouchOutcome*>& touches) const {
  const auto centre = [&](layout::ModuleId m) {
    const auto& c = design_.layout.modules[static_cast<std::size_t>(m)].corner_mm;
    return design::Vec3((c[0] + c[1] + c[2]) / 3.0);
  };
  const auto distance_mm = [&](layout::ModuleId a, layout::ModuleId b) { return (centre(a) - centre(b)).norm(); };
  for (const TouchOutcome* a : touches) {
    for (const TouchOutcome* b : touches) {
      if (std::abs(distance_mm(a->module, b->module) - distance_mm(a->answered, b->answered)) > kSameDistance_mm)
        return false;
    }
  }
  return true;
}

// Most modules answer at other places, and these form the mirrored or turned shape of the modules.
void Diagnosis::examine_mirrored(const PatchState& p) {
  const std::vector<const TouchOutcome*> whole = whole_touches(p.patch);
  const auto moved = static_cast<std::size_t>(
      std::ranges::count_if(whole, [](const TouchOutcome* t) { return t->answered != t->module; }));
  if (moved < 4 || 5 * moved < 3 * whole.size() || !keep_distances(whole)) return;
  add(FindingKind::kMirroredPatch, layout::ModuleId::none(), p.patch,
      fmt::format("patch {}: it is mounted as its mirror image, or turned: {} of {} {} for others", p.patch, moved,
                  counted(whole.size(), "module"), agreeing(moved, "answers", "answer")),
      "compare the patch with the assembly sheet; it may belong to the other side of the robot");
  for (const TouchOutcome* t : whole) {
    bad_.insert(t->module);
    explained_.insert(t->module);
  }
}

void Diagnosis::examine_silent_taxels(const TouchOutcome& t, layout::PatchIndex patch) {
  for (layout::TaxelIndex taxel; taxel < layout::kTaxelsPerModule; ++taxel) {
    const bool reported =
        std::ranges::any_of(findings_, [&](const Finding& f) { return f.module == t.module && f.taxel == taxel; });
    if ((t.silent_taxels >> taxel & 1) == 0 || reported) continue;
    add(FindingKind::kFrozenTaxel, t.module, patch,
        fmt::format("{}: taxel {} does not change under a finger, the others do", where(t.module), taxel),
        "look for a broken trace to the pad")
        .taxel = taxel;
  }
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
  const layout::PatchIndex patch = wiring_[static_cast<std::size_t>(t.module)].patch;
  if (t.answered == t.module) {
    examine_silent_taxels(t, patch);
    if (t.turned == 0 || explained_.contains(t.module)) return;
    add(FindingKind::kRotatedModule, t.module, patch,
        fmt::format("{}: is turned by {}°: a tip on one taxel moves another", where(t.module), 120 * t.turned),
        "turn the module back, or compare it with the assembly sheet");
    return;
  }
  if (explained_.contains(t.module)) return;  // The module is absent, on a stuck line, or the other half of a swap.
  if (t.answered < 0 || !t.whole) {           // A neighbour that only feels the rim of the finger is no answer.
    add(FindingKind::kNoTouchResponse, t.module, patch,
        where(t.module) + ": answers, but none of its taxels changes under a finger",
        "press it again; then replace the module");
    return;
  }
  examine_other_answer(t, patch);
}

void Diagnosis::examine_other_answer(const TouchOutcome& t, layout::PatchIndex patch) {
  const std::vector<layout::ModuleId> ring = ring_from(t.module);
  if (ring.size() > 2) {
    add(FindingKind::kWrongOrder, t.module, patch,
        fmt::format("patch {}: modules {} are in the wrong order: pressing each moves the next, the last moves the "
                    "first",
                    patch, fmt::join(ring, ", ")),
        "compare the straps of these modules with the assembly sheet")
        .other = t.answered;
  } else if (ring.size() == 2) {
    add(FindingKind::kSwappedModules, t.module, patch,
        fmt::format("{} and {} are swapped: pressing one moves the taxels of the other", where(t.module),
                    where(t.answered)),
        "exchange their straps, or their places")
        .other = t.answered;
  } else {
    add(FindingKind::kTouchedOtherModule, t.module, patch,
        fmt::format("{} was to be pressed, {} answered", where(t.module), where(t.answered)),
        "press the right module, or compare the straps of both with the assembly sheet")
        .other = t.answered;
  }
  bad_.insert(ring.begin(), ring.end());
  explained_.insert(ring.begin(), ring.end());
}

}  // namespace triskin::diagnose
