// SPDX-License-Identifier: GPL-3.0-or-later
// The host's prediction for a failure and the result of the controller must agree.
#include <gtest/gtest.h>

#include <algorithm>
#include <bit>

#include "random_patch.hpp"
#include "support/random_design.hpp"
#include "triskin/design/joint.hpp"
#include "triskin/diagnose/topology.hpp"
#include "triskin/session/patch_table.hpp"

namespace triskin::test {
namespace {

SwitchedPatch model_of(const design::Design& design, std::uint64_t seed) {
  design::PortEnds joints;
  for (const auto& ends : design::joints_of(design, layout::PatchIndex{0})) {
    auto& row = joints.emplace_back();
    for (std::size_t p = 0; p < 3; ++p) row[p] = {ends[p].row, ends[p].port};
  }
  SwitchedPatch model(std::move(joints), 0, seed);
  if (const layout::PatchImage table = session::image_of(design, layout::PatchIndex{0}); table.second_entry != 0) {
    model.set_second_cable(
        {layout::TableRow{layout::joint_row(table.second_entry)}, layout::joint_port(table.second_entry)});
  }
  return model;
}

int row_of(const design::Patch& patch, int node) {
  return static_cast<int>(std::ranges::find(patch.modules, node, &design::RoutedModule::node) - patch.modules.begin());
}

void break_it(SwitchedPatch& model, const design::Design& design, const design::FailureLoss& f, bool broken) {
  const design::Patch& patch = design.patches[0];
  if (f.other_node < 0) return model.set_dead(layout::TableRow{row_of(patch, f.node)}, broken);
  const int a = row_of(patch, f.node), b = row_of(patch, f.other_node);
  const auto ends = design::joints_of(design, layout::PatchIndex{0});
  for (int p = 0; p < 3; ++p) {
    if (ends[static_cast<std::size_t>(a)][static_cast<std::size_t>(p)].row != b) continue;
    model.set_joint({layout::TableRow{a}, p},
                    broken ? SwitchedPatch::JointFault::kOpen : SwitchedPatch::JointFault::kNone);
  }
}

TEST(Prediction, every_failure_of_a_design_costs_what_the_host_said) {
  std::mt19937_64 random(11);
  int failures = 0, backups = 0, seconds = 0;
  for (int trial = 0; trial < 60; ++trial) {
    const design::Design design = random_design(2 + trial % 15, random);
    ASSERT_EQ(design.patches.size(), 1U);
    const design::Patch& patch = design.patches[0];
    SwitchedPatch model = model_of(design, random());
    ModelledChain chain(model);
    fw::Topology topology(chain);
    const layout::PatchImage normal = session::image_of(design, layout::PatchIndex{0});
    const auto healthy = topology.reroute(fw::Topology::table_of(normal));
    ASSERT_TRUE(healthy.complete && healthy.as_table && healthy.min_depth) << trial;
    ASSERT_EQ(healthy.max_depth, patch.max_depth);
    for (const design::FailureLoss& f : patch.failures) {
      ++failures;
      break_it(model, design, f, true);
      const auto report = topology.reroute(fw::Topology::table_of(normal));
      const int n = static_cast<int>(patch.modules.size());
      // The first cable must reach what the host predicted for one entry; if the entry died, the second must reach what
      // it predicted for two.
      const bool entry_died = f.other_node < 0 && f.node == patch.entry;
      if (entry_died || !report.second_cable) {
        EXPECT_EQ(std::popcount(report.alive), n - (entry_died ? f.lost_backed_up : f.lost_one_entry))
            << trial << " module " << f.node << " other " << f.other_node;
      } else {
        EXPECT_GE(std::popcount(report.alive), n - f.lost_one_entry)
            << trial << " module " << f.node << " other " << f.other_node;
      }
      seconds += report.second_cable ? 1 : 0;
      if (f.lost_one_entry < n) {
        const layout::PatchImage backup = session::image_of(design, layout::PatchIndex{0},
                                                            {layout::ModuleId{f.node}, layout::ModuleId{f.other_node}});
        ASSERT_EQ(backup.module_count, n - f.lost_one_entry)
            << trial << " module " << f.node << " other " << f.other_node;
        const auto prepared = topology.reroute(fw::Topology::table_of(backup));
        EXPECT_TRUE(prepared.complete && prepared.as_table)
            << trial << " module " << f.node << " other " << f.other_node;
        EXPECT_EQ(std::popcount(prepared.alive), backup.module_count);
        // The controller's own tree is never deeper than the prepared one.
        if (!report.second_cable) {
          EXPECT_LE(report.max_depth, prepared.max_depth);
        }
        ++backups;
      }
      break_it(model, design, f, false);
    }
  }
  EXPECT_GE(failures, 800);
  EXPECT_GE(seconds, 40);
  std::printf("%d failures, %d prepared trees, %d read over the second cable\n", failures, backups, seconds);
}

TEST(Tables, of_random_designs_hold_every_joint_and_survive_the_round_trip) {
  std::mt19937_64 random(12);
  for (int trial = 0; trial < 200; ++trial) {
    const design::Design design = random_design(1 + trial % 16, random);
    const layout::PatchImage image = session::image_of(design, layout::PatchIndex{0});
    EXPECT_EQ(layout::check(image), Status::kOk);
    const auto bytes = session::bytes_of(image);
    const auto back = layout::decode(bytes);
    ASSERT_TRUE(back);
    EXPECT_EQ(*back, image);
    if (image.module_count < 2) continue;
    layout::PatchImage damaged = image;  // The joint has only one end.
    auto& joints = damaged.modules[1].joints;
    *std::ranges::find_if(joints, [](std::uint8_t j) { return j != 0; }) = 0;
    EXPECT_EQ(layout::check(damaged), Status::kBadTree);
    damaged = image;
    damaged.modules[1].joints[0] = 49;
    EXPECT_NE(layout::check(damaged), Status::kOk);
  }
}

}  // namespace
}  // namespace triskin::test
