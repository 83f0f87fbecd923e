// SPDX-License-Identifier: GPL-3.0-or-later
// Seeds pairs of mistakes on switched patches: each cause must give one finding, and nothing else any.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <random>

#include "support/random_design.hpp"
#include "triskin/deploy/flash.hpp"
#include "triskin/design/joint.hpp"
#include "triskin/diagnose/verify.hpp"
#include "triskin/hardware/sim_link.hpp"
#include "triskin/session/bus.hpp"

namespace triskin::test {
namespace {

using diagnose::FindingKind;
using hardware::FaultKind;

// A patch and its fault.
struct Seeded {
  hardware::Fault fault;
  FindingKind kind = FindingKind::kMissingModule;
  std::set<int> concerned;  // Modules that a second mistake must leave alone.
};

std::set<int> subtree_of(const design::Patch& patch, int module) {
  std::set<int> below{module};
  for (const design::RoutedModule& m : patch.modules) {
    if (below.contains(m.parent)) below.insert(m.node);  // Parents precede their children.
  }
  return below;
}

hardware::Fault fault_of(FaultKind kind, int module, int other = -1) {
  hardware::Fault f;
  f.kind = kind;
  f.module = layout::ModuleId{module};
  f.other = layout::ModuleId{other};
  return f;
}

// Opens a joint whose loss separates the modules behind it from the entry; the design lists these as bridges.
std::optional<Seeded> open_bridge(const design::Patch& patch, std::mt19937_64& random) {
  std::vector<std::array<int, 2>> bridges;
  for (const auto& b : patch.bridges) bridges.push_back({b[0], b[1]});
  if (bridges.empty()) return std::nullopt;
  const auto [a, b] = bridges[random() % bridges.size()];
  const auto row = [&](int m) { return std::ranges::find(patch.modules, m, &design::RoutedModule::node); };
  const int far = row(b)->parent == a ? b : a, near = far == b ? a : b;
  std::set<int> concerned = subtree_of(patch, far);
  // A leaf and its joint cannot be told apart.
  const FindingKind kind = concerned.size() > 1 ? FindingKind::kMissingJoint : FindingKind::kMissingModule;
  concerned.insert(near);
  return Seeded{fault_of(FaultKind::kOpenJoint, a, b), kind, concerned};
}

// Picks a module without children, so that its loss concerns only itself.
std::optional<Seeded> on_leaf(const design::Patch& patch, std::mt19937_64& random, FaultKind fault, FindingKind kind) {
  for (int k = 0; k < 100; ++k) {
    const design::RoutedModule& m = patch.modules[random() % patch.modules.size()];
    if (m.parent < 0 || subtree_of(patch, m.node).size() > 1) continue;
    Seeded s{fault_of(fault, m.node), kind, {m.node, m.parent}};
    s.fault.value = fault == FaultKind::kWrongId ? 0x1490 : 1;
    s.fault.taxel = layout::TaxelIndex{1};
    return s;
  }
  return std::nullopt;
}

std::optional<Seeded> seeded(int kind, const design::Patch& patch, std::mt19937_64& random) {
  switch (kind) {
    case 0:
      return open_bridge(patch, random);
    case 1:
      return on_leaf(patch, random, FaultKind::kDeadModule, FindingKind::kMissingModule);
    case 2:
      return on_leaf(patch, random, FaultKind::kRotatedModule, FindingKind::kRotatedModule);
    case 3:
      return on_leaf(patch, random, FaultKind::kWrongId, FindingKind::kWrongId);
    default:
      return on_leaf(patch, random, FaultKind::kSaturatedTaxel, FindingKind::kSaturatedTaxel);
  }
}
constexpr int kKinds = 5;

bool disjoint(const std::set<int>& a, const std::set<int>& b) {
  return std::ranges::none_of(a, [&](int m) { return b.contains(m); });
}

diagnose::VerifyResult verified(const design::Design& design, const Seeded& one, const Seeded& two) {
  hardware::Scene scene;
  scene.design = design;
  scene.switched = true;
  scene.faults = {one.fault, two.fault};
  hardware::SimLink link(std::move(scene));
  session::Bus bus(link);
  deploy::flash(bus, design);
  return diagnose::verify(bus, design, {});
}

bool names(const diagnose::Finding& f, const Seeded& s) {
  return f.kind == s.kind && (s.concerned.contains(f.module) || s.concerned.contains(f.other));
}

std::string text_of(const diagnose::VerifyResult& r) {
  std::string text;
  for (const diagnose::Finding& f : r.findings)
    text += fmt::format("{}: {}\n", diagnose::kFindingKindNames.name(f.kind), f.text);
  return text;
}

TEST(SwitchedPairs, twenty_pairs_have_one_finding_for_each_cause) {
  std::mt19937_64 random(41);
  int pairs = 0, exact = 0;
  for (int seed = 0; pairs < 20 && seed < 200; ++seed) {
    const design::Design design = random_design(14, random);
    const design::Patch& patch = design.patches[0];
    const auto one = seeded(seed % kKinds, patch, random);
    const auto two = seeded(seed / kKinds % kKinds, patch, random);
    if (!one || !two || !disjoint(one->concerned, two->concerned)) continue;
    ++pairs;
    const diagnose::VerifyResult r = verified(design, *one, *two);
    const bool both = r.findings.size() == 2 && ((names(r.findings[0], *one) && names(r.findings[1], *two)) ||
                                                 (names(r.findings[0], *two) && names(r.findings[1], *one)));
    exact += both ? 1 : 0;
    EXPECT_TRUE(both) << "seed " << seed << ": " << hardware::kFaultKindNames.name(one->fault.kind) << " of "
                      << one->fault.module << ", " << hardware::kFaultKindNames.name(two->fault.kind) << " of "
                      << two->fault.module << "\n"
                      << text_of(r);
  }
  EXPECT_EQ(pairs, 20);
  EXPECT_EQ(exact, 20);
}

}  // namespace
}  // namespace triskin::test
