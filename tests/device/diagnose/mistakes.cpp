// SPDX-License-Identifier: GPL-3.0-or-later
#include "device/diagnose/mistakes.hpp"

#include <algorithm>
#include <bit>

#include "triskin/deploy/flash.hpp"
#include "triskin/hardware/sim_link.hpp"

namespace triskin::test {
namespace {

using diagnose::FindingKind;
using hardware::FaultKind;
using Random = std::mt19937_64;

constexpr int kTries = 200;
constexpr std::uint64_t kHappens_us = 1'000'000, kAway_us = 400'000;

int any(std::size_t count, Random& random) {
  return static_cast<int>(random() % count);
}

/// Picks a module that no mistake concerns and that `fits`; −1 if there is none.
int pick(Hardware& h, Random& random, const std::function<bool(int)>& fits = {}) {
  for (int k = 0; k < kTries; ++k) {
    const int m = any(h.intended.layout.modules.size(), random);
    if (!h.used.contains(m) && (!fits || fits(m))) return m;
  }
  return -1;
}

hardware::Fault& fault(Hardware& h, FaultKind kind, int module) {
  hardware::Fault f;
  f.kind = kind;
  f.module = layout::ModuleId{module};
  h.used.insert(module);
  return h.faults.emplace_back(f);
}

bool is_free(Hardware& h, int patch, int line, int address) {
  return std::ranges::none_of(h.built.patches[static_cast<std::size_t>(patch)].modules,
                              [&](const auto& m) { return m.line == line && m.address == address; });
}

/// Returns the straps of `module` changed by `bits` (line in bits 2 and 3).
std::pair<int, int> strapped(Hardware& h, int module, int bits) {
  const auto& r = h.routed(module);
  return {r.line ^ (bits >> 2), r.address ^ (bits & 3)};
}

std::optional<Expected> on_module(Hardware& h, Random& random, FaultKind fault_kind, FindingKind finding,
                                  const std::function<void(hardware::Fault&)>& change = {}) {
  const int m = pick(h, random);
  if (m < 0) return std::nullopt;
  hardware::Fault& f = fault(h, fault_kind, m);
  if (change) change(f);
  return Expected{finding, {m}};
}

std::optional<Expected> strap(Hardware& h, Random& random, bool one_bit, bool onto_free) {
  int bits = 0;
  const int m = pick(h, random, [&](int k) {
    bits = one_bit ? 1 << any(4, random) : 1 + any(15, random);
    if (!one_bit && std::popcount(static_cast<unsigned>(bits)) < 2) return false;
    const auto [line, address] = strapped(h, k, bits);
    return !h.used_patches.contains(h.patch_of(k)) && is_free(h, h.patch_of(k), line, address) == onto_free;
  });
  if (m < 0) return std::nullopt;
  const auto [line, address] = strapped(h, m, bits);
  std::set<int> named{m};
  for (const auto& o : h.built.patches[static_cast<std::size_t>(h.patch_of(m))].modules) {
    if (o.line == line && o.address == address) named.insert(o.node);
  }
  for (const int n : named) {
    if (n != m && h.used.contains(n)) return std::nullopt;
  }
  hardware::Fault& f = fault(h, FaultKind::kMovedChip, m);
  f.line = line;
  f.address = address;
  h.used.insert(named.begin(), named.end());
  return Expected{onto_free ? FindingKind::kWrongAddress : FindingKind::kDuplicateAddress, named};
}

/// Rotates the places of the modules: each takes the next one's place.
std::optional<Expected> rotate_places(Hardware& h, const std::vector<int>& ring, FindingKind finding) {
  const design::RoutedModule first = h.routed(ring[0]);
  for (std::size_t k = 0; k < ring.size(); ++k) {
    const design::RoutedModule next = k + 1 < ring.size() ? h.routed(ring[k + 1]) : first;
    h.routed(ring[k]).line = next.line;
    h.routed(ring[k]).address = next.address;
  }
  h.used.insert(ring.begin(), ring.end());
  return Expected{finding, {ring.begin(), ring.end()}};
}

std::optional<Expected> wrong_order(Hardware& h, Random& random, std::size_t count) {
  std::vector<int> ring;
  while (ring.size() < count) {
    const int m = pick(h, random, [&](int k) {
      return (ring.empty() || h.patch_of(k) == h.patch_of(ring[0])) && std::ranges::find(ring, k) == ring.end() &&
             !h.used_patches.contains(h.patch_of(k));
    });
    if (m < 0) return std::nullopt;
    ring.push_back(m);
  }
  return rotate_places(h, ring, count == 2 ? FindingKind::kSwappedModules : FindingKind::kWrongOrder);
}

std::optional<Expected> swapped_across(Hardware& h, Random& random) {
  const int a = pick(h, random);
  const int b = a < 0 ? -1 : pick(h, random, [&](int k) { return h.patch_of(k) != h.patch_of(a); });
  if (b < 0 || h.used_patches.contains(h.patch_of(a)) || h.used_patches.contains(h.patch_of(b))) return std::nullopt;
  fault(h, FaultKind::kSwappedChips, a).other = layout::ModuleId{b};
  h.used.insert(b);
  return Expected{FindingKind::kSwappedModules, {a, b}};
}

// Swaps lines with three modules or more: fewer look like swapped or wrongly strapped modules, and need the same
// repair.
std::optional<Expected> swapped_lines(Hardware& h, Random& random) {
  for (int k = 0; k < kTries; ++k) {
    const int p = any(h.built.patches.size(), random), a = any(4, random), b = any(4, random);
    auto& modules = h.built.patches[static_cast<std::size_t>(p)].modules;
    const auto on = [&](const auto& m) { return m.line == a || m.line == b; };
    const bool untouched =
        std::ranges::none_of(modules, [&](const auto& m) { return on(m) && h.used.contains(m.node); });
    if (a == b || h.used_patches.contains(p) || std::ranges::count_if(modules, on) < 3 || !untouched) continue;
    for (auto& m : modules) {
      if (!on(m)) continue;
      m.line = m.line == a ? b : a;
      h.used.insert(m.node);
    }
    h.used_patches.insert(p);
    return Expected{FindingKind::kSwappedLines, {}, p};
  }
  return std::nullopt;
}

std::optional<Expected> swapped_cables(Hardware& h, Random& random) {
  const int p = any(h.built.patches.size(), random), q = any(h.built.patches.size(), random);
  if (p == q || h.used_patches.contains(p) || h.used_patches.contains(q)) return std::nullopt;
  hardware::Fault f;
  f.kind = FaultKind::kSwappedPatches;
  f.patch = layout::PatchIndex{p};
  f.other_patch = layout::PatchIndex{q};
  h.faults.push_back(f);
  h.used_patches.insert(p);
  h.used_patches.insert(q);
  return Expected{FindingKind::kWrongPatch, {}, std::min(p, q)};
}

// Puts the last module at the place of the first, and so on; a strip of odd length thus becomes its mirror image.
std::optional<Expected> mirrored(Hardware& h, Random&) {
  auto& modules = h.built.patches[0].modules;
  if (h.built.name != "strip" || !h.used_patches.empty()) return std::nullopt;
  const auto as_meant = modules;
  for (std::size_t k = 0; k < modules.size(); ++k) {
    modules[k].line = as_meant[modules.size() - 1 - k].line;
    modules[k].address = as_meant[modules.size() - 1 - k].address;
    if (!h.used.insert(modules[k].node).second) return std::nullopt;
  }
  h.used_patches.insert(0);
  return Expected{FindingKind::kMirroredPatch, {}, 0};
}

/// Concerns everything behind the joint of a module and its parent.
std::optional<Expected> behind_joint(Hardware& h, Random& random, FaultKind kind, FindingKind finding) {
  const int m = pick(h, random, [&](int k) {
    const auto below = h.subtree(k);
    return h.routed(k).parent >= 0 && below.size() >= 2 &&
           std::ranges::none_of(below, [&](int n) { return h.used.contains(n); });
  });
  if (m < 0) return std::nullopt;
  for (const int n : h.subtree(m)) {
    hardware::Fault& f = fault(h, kind, n);
    if (finding == FindingKind::kMissingJoint) continue;
    f.from_us = h.verify_at_us + kHappens_us;
    f.until_us = f.from_us + kAway_us;
  }
  return Expected{finding, {m}};
}

/// Concerns the modules of one line behind a joint, or behind the cable, while other lines pass there.
std::optional<Expected> open_line(Hardware& h, Random& random, bool loose) {
  for (int k = 0; k < kTries; ++k) {
    const int top = any(h.intended.layout.modules.size(), random), line = any(layout::kLines, random);
    const std::vector<int> below = h.subtree(top);
    std::vector<int> on_line;
    for (const int m : below) {
      if (h.routed(m).line == line) on_line.push_back(m);
    }
    // A subtree that has all of these modules and no others looks like a broken joint.
    const bool is_subtree = std::ranges::any_of(
        on_line, [&](int m) { return h.subtree(m).size() == on_line.size() && h.subtree(m).back() == on_line.back(); });
    const bool is_used = std::ranges::any_of(on_line, [&](int m) { return h.used.contains(m); });
    if (on_line.size() < 3 || is_subtree || is_used || h.used_patches.contains(h.patch_of(top))) continue;
    for (const int m : on_line) {
      hardware::Fault& f = fault(h, FaultKind::kRemovedChip, m);
      if (!loose) continue;
      f.from_us = h.verify_at_us + kHappens_us;
      f.until_us = f.from_us + kAway_us;
    }
    return Expected{loose ? FindingKind::kLooseJoint : FindingKind::kMissingJoint, {}, h.patch_of(top), line};
  }
  return std::nullopt;
}

std::optional<Expected> for_a_while(Hardware& h, Random& random, FaultKind kind, FindingKind finding) {
  const int m = pick(h, random);
  if (m < 0) return std::nullopt;
  hardware::Fault& f = fault(h, kind, m);
  f.from_us = h.verify_at_us + kHappens_us;
  f.until_us = f.from_us + kAway_us;
  return Expected{finding, {m}};
}

std::optional<Expected> short_of_line(Hardware& h, Random& random, int frees_after_pulses) {
  const int m = pick(h, random);
  if (m < 0 || h.used_patches.contains(h.patch_of(m))) return std::nullopt;
  hardware::Fault f;
  f.kind = FaultKind::kStuckLine;
  f.patch = layout::PatchIndex{h.patch_of(m)};
  f.line = h.routed(m).line;
  f.stuck_scl = frees_after_pulses == 0 && random() % 2 == 0;
  f.frees_after_pulses = frees_after_pulses;
  if (frees_after_pulses > 0) f.from_us = h.verify_at_us + kHappens_us;
  for (const auto& o : h.built.patches[static_cast<std::size_t>(f.patch)].modules) {
    if (o.line == f.line && h.used.contains(o.node)) return std::nullopt;
  }
  for (const auto& o : h.built.patches[static_cast<std::size_t>(f.patch)].modules) {
    if (o.line == f.line) h.used.insert(o.node);
  }
  h.used_patches.insert(f.patch);
  h.faults.push_back(f);
  return Expected{FindingKind::kStuckLine, {}, f.patch, f.line};
}

std::optional<Expected> all_taxels(Hardware& h, Random& random, FaultKind kind, FindingKind finding) {
  const int m = pick(h, random);
  if (m < 0) return std::nullopt;
  for (int t = 0; t < layout::kTaxelsPerModule; ++t) fault(h, kind, m).taxel = layout::TaxelIndex{t};
  return Expected{finding, {m}};
}

std::optional<Expected> one_taxel(Hardware& h, Random& random, FaultKind kind, FindingKind finding) {
  int taxel = 0;
  do {
    taxel = any(layout::kTaxelsPerModule, random);
  } while (!layout::measures_pressure(static_cast<std::size_t>(taxel)));
  return on_module(h, random, kind, finding, [&](hardware::Fault& f) { f.taxel = layout::TaxelIndex{taxel}; });
}

std::optional<Expected> finger_elsewhere(Hardware& h, Random& random) {
  const int a = pick(h, random);
  const int b = a < 0 ? -1 : pick(h, random, [&](int k) { return k != a; });
  if (b < 0 || !h.used_patches.empty()) return std::nullopt;
  fault(h, FaultKind::kFingerElsewhere, a).other = layout::ModuleId{b};
  h.used.insert(b);
  return Expected{FindingKind::kTouchedOtherModule, {a}};
}

std::optional<Expected> other_design(Hardware& h, Random&) {
  h.flashed = h.intended;
  auto& modules = h.flashed->patches[0].modules;  // A later patch may have a single module.
  std::swap(modules[0].address, modules.back().address);
  std::swap(modules[0].line, modules.back().line);
  h.flashed->design_id = design::design_id_of(*h.flashed);
  return Expected{FindingKind::kWrongTable, {}};
}

}  // namespace

bool Expected::matches(const diagnose::Finding& f) const {
  if (f.kind != kind || (line >= 0 && f.line != line)) return false;
  if (patch >= 0 && f.patch != patch) return false;
  return modules.empty() || modules.contains(f.module) || modules.contains(f.other);
}

design::RoutedModule& Hardware::routed(int module) {
  auto& modules = built.patches[static_cast<std::size_t>(patch_of(module))].modules;
  return *std::ranges::find(modules, module, &design::RoutedModule::node);
}

int Hardware::patch_of(int module) const {
  for (std::size_t p = 0; p < intended.patches.size(); ++p) {
    if (std::ranges::count(intended.patches[p].modules, module, &design::RoutedModule::node) > 0)
      return static_cast<int>(p);
  }
  return -1;
}

std::vector<int> Hardware::subtree(int module) const {
  std::vector<int> below{module};
  for (const auto& m : intended.patches[static_cast<std::size_t>(patch_of(module))].modules) {
    // Parents precede children in the list.
    if (std::ranges::find(below, m.parent) != below.end()) below.push_back(m.node);
  }
  return below;
}

const std::vector<Mistake>& mistakes() {
  using H = Hardware;
  using R = Random;
  using F = FaultKind;
  using K = FindingKind;
  static const std::vector<Mistake> all{
      {"dead_chip", "a chip is missing or dead", false,
       [](H& h, R& r) { return on_module(h, r, F::kRemovedChip, K::kAbsentModule); }},
      {"wrong_chip", "another part is soldered", false,
       [](H& h, R& r) {
         return on_module(h, r, F::kWrongId, K::kWrongId, [](hardware::Fault& f) { f.value = 0x1490; });
       }},
      {"missing_strap", "one strap wrong, the place is free", false,
       [](H& h, R& r) { return strap(h, r, true, true); }},
      {"wrong_straps", "several straps wrong, the place is free", false,
       [](H& h, R& r) { return strap(h, r, false, true); }},
      {"doubled_address", "one strap wrong, another module has the place", false,
       [](H& h, R& r) { return strap(h, r, true, false); }},
      {"swapped_modules", "two modules of a patch exchanged", false, [](H& h, R& r) { return wrong_order(h, r, 2); }},
      {"wrong_order", "three modules of a patch in wrong order", false,
       [](H& h, R& r) { return wrong_order(h, r, 3); }},
      {"swapped_across", "two modules of different patches exchanged", false, swapped_across},
      {"rotated_module", "a module turned by 120° or 240°", false,
       [](H& h, R& r) {
         const int steps = 1 + any(2, r);
         return on_module(h, r, F::kRotatedModule, K::kRotatedModule, [&](hardware::Fault& f) { f.value = steps; });
       }},
      {"mirrored_patch", "a patch mounted as its mirror image", false, mirrored},
      {"swapped_lines", "two lines of a cable exchanged", false, swapped_lines},
      {"swapped_cables", "the cables of two controllers exchanged", false, swapped_cables},
      {"broken_joint", "a joint carries nothing: all behind it is silent", false,
       [](H& h, R& r) { return behind_joint(h, r, F::kRemovedChip, K::kMissingJoint); }},
      {"loose_joint", "all behind a joint goes and comes together", false,
       [](H& h, R& r) { return behind_joint(h, r, F::kRemovedChip, K::kLooseJoint); }},
      {"open_line", "a line is open at a joint: its modules behind it are silent", false,
       [](H& h, R& r) { return open_line(h, r, false); }},
      {"loose_line", "the modules of a line behind a joint go and come together", false,
       [](H& h, R& r) { return open_line(h, r, true); }},
      {"loose_module", "one module goes and comes", false,
       [](H& h, R& r) { return for_a_while(h, r, F::kRemovedChip, K::kIntermittentModule); }},
      {"sagging_supply", "the supply behind a joint dips", false,
       [](H& h, R& r) { return behind_joint(h, r, F::kLostConfiguration, K::kSaggingSupply); }},
      {"supply_dip", "the supply of one module dips", false,
       [](H& h, R& r) { return for_a_while(h, r, F::kLostConfiguration, K::kLostConfiguration); }},
      {"shorted_line", "SDA or SCL of a line held low", false, [](H& h, R& r) { return short_of_line(h, r, 0); }},
      {"passing_short", "a line held low until clock pulses free it", false,
       [](H& h, R& r) { return short_of_line(h, r, 5); }},
      {"saturated_taxel", "a taxel fixed at an end of its range", false,
       [](H& h, R& r) { return one_taxel(h, r, F::kSaturatedTaxel, K::kSaturatedTaxel); }},
      {"frozen_taxel", "a taxel keeps one value", false,
       [](H& h, R& r) { return one_taxel(h, r, F::kFrozenTaxel, K::kFrozenTaxel); }},
      {"saturated_module", "all taxels of a module at an end of their range", false,
       [](H& h, R& r) { return all_taxels(h, r, F::kSaturatedTaxel, K::kSaturatedTaxel); }},
      {"numb_module", "no taxel of a module feels anything", false,
       [](H& h, R& r) { return all_taxels(h, r, F::kFrozenTaxel, K::kNoTouchResponse); }},
      {"wrong_finger", "the person pressed another module", false, finger_elsewhere},
      {"other_design", "the controllers hold the tables of another part", true, other_design},
      {"fresh_boards", "the controllers were never flashed", true,
       [](H& h, R&) {
         h.fresh = true;
         return std::optional(Expected{K::kNotFlashed, {}});
       }},
  };
  return all;
}

diagnose::VerifyResult verify_built(Hardware hardware) {
  hardware::Scene scene;
  scene.design = hardware.built;
  scene.faults = hardware.faults;
  scene.effects.noise_counts = 3.0;
  scene.effects.taxel_spread_counts = 400.0;
  hardware::SimLink link(std::move(scene));
  session::Bus bus(link);
  if (!hardware.fresh) (void)deploy::flash(bus, hardware.flashed.value_or(hardware.intended), {});
  if (bus.now_us() < hardware.verify_at_us) bus.listen(hardware.verify_at_us);
  diagnose::VerifyOptions options;
  options.touch = true;
  options.actuator = &link;
  return diagnose::verify(bus, hardware.intended, options);
}

}  // namespace triskin::test
