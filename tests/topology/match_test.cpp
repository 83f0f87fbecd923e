// SPDX-License-Identifier: GPL-3.0-or-later
// Compares the modules found on the chain with the design: every difference must be named.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "support/random_design.hpp"
#include "triskin/deploy/flash.hpp"
#include "triskin/diagnose/topology.hpp"
#include "triskin/diagnose/verify.hpp"
#include "triskin/hardware/sim_link.hpp"
#include "triskin/session/bus.hpp"
#include "triskin/session/controller.hpp"

namespace triskin::test {
namespace {

using hardware::FaultKind;

hardware::Fault fault(FaultKind kind, int module, int other = -1, int value = 0) {
  hardware::Fault f;
  f.kind = kind;
  f.module = layout::ModuleId{module};
  f.other = layout::ModuleId{other};
  f.value = value;
  return f;
}

hardware::Scene assembled(const design::Design& design, std::vector<hardware::Fault> faults) {
  hardware::Scene s;
  s.design = design;
  s.switched = true;
  s.faults = std::move(faults);
  return s;
}

wire::FoundTopology found_on(const design::Design& design, std::vector<hardware::Fault> faults = {}) {
  hardware::SimLink link(assembled(design, std::move(faults)));
  session::Bus bus(link);
  session::Controller controller(bus, 1);
  controller.reroute();
  return controller.topology();
}

diagnose::VerifyResult verified(const design::Design& design, std::vector<hardware::Fault> faults) {
  hardware::SimLink link(assembled(design, std::move(faults)));
  session::Bus bus(link);
  deploy::flash(bus, design);
  return diagnose::verify(bus, design, {});
}

const diagnose::TopologyDifference& only(const diagnose::TopologyMatch& m) {
  static const diagnose::TopologyDifference kNone;
  EXPECT_EQ(m.differences.size(), 1U);
  for (const auto& d : m.differences) EXPECT_FALSE(d.text.empty() || d.remedy.empty());
  return m.differences.empty() ? kNone : m.differences[0];
}

// Returns a joint whose loss separates nobody from the entry, between modules that are not the entry; −1 when there
// is none.
std::pair<int, int> spare_joint(const design::Design& design) {
  const design::Patch& patch = design.patches[0];
  for (const auto& m : patch.modules) {
    for (const int other : design.layout.modules[static_cast<std::size_t>(m.node)].neighbour) {
      if (other < 0 || m.node == patch.entry || other == patch.entry) continue;
      const bool bridge = std::ranges::any_of(
          patch.bridges, [&](const auto& b) { return std::minmax(b[0], b[1]) == std::minmax(m.node, other); });
      if (!bridge) return {m.node, other};
    }
  }
  return {-1, -1};
}

TEST(Match, a_patch_as_designed_has_no_differences_and_every_module_its_place) {
  std::mt19937_64 random(31);
  for (int trial = 0; trial < 40; ++trial) {
    const design::Design design = random_design(2 + trial % 15, random);
    const auto match = diagnose::match_topology(found_on(design), design, layout::PatchIndex{0});
    EXPECT_TRUE(match.differences.empty()) << trial << ' ' << match.differences[0].text;
    EXPECT_EQ(std::set<int>(match.module_of.begin(), match.module_of.end()).size(), design.layout.modules.size());
  }
}

TEST(Match, names_a_missing_joint_an_absent_module_and_a_turned_one) {
  std::mt19937_64 random(32);
  int joints = 0;
  for (int trial = 0; trial < 40; ++trial) {
    const design::Design design = random_design(10 + trial % 7, random);
    const design::Patch& patch = design.patches[0];
    if (const auto [a, b] = spare_joint(design); a >= 0) {
      const auto match = diagnose::match_topology(found_on(design, {fault(FaultKind::kOpenJoint, a, b)}), design,
                                                  layout::PatchIndex{0});
      const auto& d = only(match);
      EXPECT_EQ(d.kind, diagnose::FindingKind::kMissingJoint);
      EXPECT_THAT((std::array{d.module, d.other}), testing::UnorderedElementsAre(a, b));
      ++joints;
    }
    const int leaf = patch.modules.back().node;
    if (std::ranges::count(patch.articulation, leaf) == 0) {
      const auto match = diagnose::match_topology(found_on(design, {fault(FaultKind::kDeadModule, leaf)}), design,
                                                  layout::PatchIndex{0});
      const auto& gone = only(match);
      EXPECT_EQ(gone.kind, diagnose::FindingKind::kMissingModule);
      EXPECT_EQ(gone.module, leaf);
    }
    const int turned = patch.modules[1 + random() % (patch.modules.size() - 1)].node;
    const int steps = 1 + static_cast<int>(random() % 2);
    const auto match = diagnose::match_topology(found_on(design, {fault(FaultKind::kRotatedModule, turned, -1, steps)}),
                                                design, layout::PatchIndex{0});
    const auto& d = only(match);
    EXPECT_EQ(d.kind, diagnose::FindingKind::kRotatedModule);
    EXPECT_EQ(d.module, turned);
    EXPECT_EQ(d.steps, steps);
  }
  EXPECT_GE(joints, 10);
}

TEST(Match, names_exchanged_modules_and_an_extra_joint) {
  std::mt19937_64 random(33);
  int exchanges = 0, extras = 0;
  for (int trial = 0; trial < 60; ++trial) {
    const design::Design design = random_design(12, random);
    const auto& modules = design.patches[0].modules;
    const auto &a = modules[1 + random() % 11], &b = modules[1 + random() % 11];
    if (a.rotation != b.rotation) {
      const auto match = diagnose::match_topology(found_on(design, {fault(FaultKind::kSwappedChips, a.node, b.node)}),
                                                  design, layout::PatchIndex{0});
      const auto& d = only(match);
      EXPECT_EQ(d.kind, diagnose::FindingKind::kSwappedModules);
      EXPECT_THAT((std::array{d.module, d.other}), testing::UnorderedElementsAre(a.node, b.node));
      ++exchanges;
    }
    // Two border modules that are no neighbours are joined by a wire.
    const auto free_sides = [&](int node) {
      return std::ranges::count(design.layout.modules[static_cast<std::size_t>(node)].neighbour, -1);
    };
    const auto& neighbour = design.layout.modules[static_cast<std::size_t>(a.node)].neighbour;
    if (a.node != b.node && free_sides(a.node) > 0 && free_sides(b.node) > 0 &&
        std::ranges::count(neighbour, b.node) == 0) {
      const auto match = diagnose::match_topology(found_on(design, {fault(FaultKind::kExtraJoint, a.node, b.node)}),
                                                  design, layout::PatchIndex{0});
      const auto& d = only(match);
      EXPECT_EQ(d.kind, diagnose::FindingKind::kExtraJoint);
      EXPECT_THAT((std::array{d.module, d.other}), testing::UnorderedElementsAre(a.node, b.node));
      ++extras;
    }
  }
  EXPECT_GE(exchanges, 20);
  EXPECT_GE(extras, 10);
}

TEST(Match, recognizes_a_patch_without_a_table_among_many_designs) {
  std::mt19937_64 random(34);
  std::vector<design::Design> designs;
  for (int k = 0; k < 12; ++k) designs.push_back(random_design(10 + k % 5, random));
  for (std::size_t k = 0; k < designs.size(); ++k) {
    const wire::FoundTopology found = found_on(designs[k]);
    EXPECT_TRUE(found.complete);
    for (std::size_t other = 0; other < designs.size(); ++other) {
      const auto match = diagnose::identify_patch(found, designs[other]);
      ASSERT_FALSE(match.empty());
      EXPECT_EQ(match[0].differences.empty(), other == k) << k << " as " << other;
    }
  }
}

TEST(Verify, of_switched_modules_says_what_the_chain_shows) {
  std::mt19937_64 random(35);
  const design::Design design = random_design(13, random);
  EXPECT_TRUE(verified(design, {}).findings.empty());
  const int turned = design.patches[0].modules.back().node;
  auto r = verified(design, {fault(FaultKind::kRotatedModule, turned, -1, 1)});
  ASSERT_EQ(r.findings.size(), 1U);
  EXPECT_EQ(r.findings[0].kind, diagnose::FindingKind::kRotatedModule);
  EXPECT_EQ(r.findings[0].module, turned);
  const auto [a, b] = spare_joint(design);
  ASSERT_GE(a, 0);
  r = verified(design, {fault(FaultKind::kOpenJoint, a, b)});
  ASSERT_EQ(r.findings.size(), 1U);
  EXPECT_EQ(r.findings[0].kind, diagnose::FindingKind::kMissingJoint);
  EXPECT_EQ(r.modules_ok, 13);
  r = verified(design, {fault(FaultKind::kDeadModule, turned)});
  ASSERT_EQ(r.findings.size(), 1U);
  EXPECT_EQ(r.findings[0].kind, diagnose::FindingKind::kMissingModule);
  EXPECT_EQ(r.modules_ok, 12);
}

TEST(Verify, names_controllers_that_are_plugged_into_each_others_patch) {
  std::mt19937_64 random(36);
  const design::Design design = random_design(28, random);
  ASSERT_EQ(design.patches.size(), 2U);
  hardware::Fault exchanged;
  exchanged.kind = FaultKind::kSwappedPatches;
  exchanged.patch = layout::PatchIndex{0};
  exchanged.other_patch = layout::PatchIndex{1};
  const auto r = verified(design, {exchanged});
  ASSERT_GE(r.findings.size(), 2U);
  for (const auto& f : r.findings) EXPECT_EQ(f.kind, diagnose::FindingKind::kWrongPatch) << f.text;
  EXPECT_EQ(r.modules_ok, 0);
}

TEST(Flash, a_prepared_route_leaves_the_failed_module_out_and_is_no_wrong_table) {
  std::mt19937_64 random(37);
  const design::Design design = random_design(12, random);
  const design::Patch& patch = design.patches[0];
  const auto failed = std::ranges::find_if(patch.failures, [&](const auto& f) {
    return f.other_node < 0 && f.node != patch.entry && f.lost_one_entry == 1;
  });
  ASSERT_NE(failed, patch.failures.end());
  hardware::SimLink link(assembled(design, {fault(FaultKind::kDeadModule, failed->node)}));
  session::Bus bus(link);
  deploy::FlashOptions options;
  options.route = {layout::ModuleId{failed->node}, layout::ModuleId::none()};
  deploy::flash(bus, design, options);
  bus.listen(bus.now_us() + 500'000);
  session::Controller controller(bus, 1);
  const wire::ActiveRoute route = controller.route();
  EXPECT_TRUE(route.complete && route.as_table);
  EXPECT_EQ(route.alive, 0x7FF);
  const auto r = diagnose::verify(bus, design, {});
  ASSERT_EQ(r.findings.size(), 1U);
  EXPECT_EQ(r.findings[0].kind, diagnose::FindingKind::kBackupRoute);
  EXPECT_EQ(r.modules_ok, 11);
  EXPECT_EQ(session::parse_route("backup:4-7", design),
            (session::RouteChoice{layout::ModuleId{4}, layout::ModuleId{7}}));
  EXPECT_THROW((void)session::parse_route("backup:x", design), InputError);
  EXPECT_THROW((void)session::parse_route("backup:4-4", design), InputError);
  options.route = {layout::ModuleId{999}, layout::ModuleId::none()};
  EXPECT_THROW(deploy::flash(bus, design, options), InputError);
}

}  // namespace
}  // namespace triskin::test
