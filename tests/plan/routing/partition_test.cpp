// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <algorithm>
#include <map>

#include "shapes.hpp"
#include "triskin/base/dice.hpp"
#include "triskin/base/error.hpp"

namespace triskin::testing {
namespace {

routing::RoutingOptions without_failures() {
  routing::RoutingOptions options;
  options.failure_analysis = false;
  return options;
}

TEST(Partition, four_hundred_patches_are_proved) {
  constexpr std::array kShapes{Shape::kCompact, Shape::kStrip, Shape::kHoled};
  double slowest = 0.0;
  for (int k = 0; k < 400; ++k) {
    SCOPED_TRACE(k);
    Dice dice(static_cast<std::uint64_t>(k));
    const Listed patch =
        random_patch(kShapes[static_cast<std::size_t>(k % 3)], 38 + dice.below(203), static_cast<std::uint64_t>(k));
    const routing::RoutingResult r = routing::route(patch.graph);
    EXPECT_TRUE(r.proved) << patch.tiles.size() << " modules: " << r.patches.size() << " patches, bound "
                          << r.lower_bound;
    slowest = std::max(slowest, r.seconds);
  }
  RecordProperty("slowest_ms", static_cast<int>(slowest * 1000));
  std::printf("slowest of 400: %.3f s\n", slowest);
}

TEST(Partition, dendritic_patches_are_proved_or_bounded) {
  int proved = 0;
  double slowest = 0.0;
  for (int k = 0; k < 50; ++k) {
    SCOPED_TRACE(k);
    Dice dice(static_cast<std::uint64_t>(k));
    const Listed patch = random_patch(Shape::kDendritic, 38 + dice.below(203), 7000 + static_cast<std::uint64_t>(k));
    const routing::RoutingResult r = routing::route(patch.graph);
    EXPECT_LE(r.lower_bound, static_cast<int>(r.patches.size()));
    EXPECT_EQ(r.proved, r.lower_bound == static_cast<int>(r.patches.size()));
    proved += r.proved ? 1 : 0;
    slowest = std::max(slowest, r.seconds);
  }
  std::printf("dendritic: %d of 50 proved, slowest %.3f s\n", proved, slowest);
  EXPECT_GE(proved, 45);
}

TEST(Partition, very_large_patch_has_an_interval) {
  const Listed patch = random_patch(Shape::kCompact, 2600, 5);
  const routing::RoutingResult r = routing::route(patch.graph);
  EXPECT_EQ(r.lower_bound, 163);  // The bound is ⌈2600 / 16⌉.
  EXPECT_LE(r.patches.size(), 165U);
  std::printf("2600 modules: [%d, %zu] in %.3f s\n", r.lower_bound, r.patches.size(), r.seconds);
}

TEST(Partition, a_star_needs_more_than_the_size_bound) {
  // A centre has three arms of 10: 31 modules, ⌈31 / 16⌉ = 2; but no two arms fit together with the centre.
  Tiles tiles{{0, 0, true}};
  for (int side = 0; side < 3; ++side) {
    Tile t = design::across({0, 0, true}, side).tile;
    for (int k = 0; k < 10; ++k) {
      tiles.insert(t);
      for (int s = 0; s < 3; ++s) {
        const Tile u = design::across(t, s).tile;
        if (tiles.contains(u) || joints(tiles, u) != 1 || center(u).norm() <= center(t).norm()) continue;
        t = u;
        break;
      }
    }
  }
  const Listed patch = listed(tiles);
  ASSERT_EQ(patch.tiles.size(), 31U);
  const routing::RoutingResult r = routing::route(patch.graph, without_failures());
  EXPECT_EQ(r.lower_bound, 3);
  EXPECT_TRUE(r.proved);
  EXPECT_EQ(r.proof, routing::PartitionProof::kFolding);
}

TEST(Partition, same_seed_same_result) {
  const Listed patch = random_patch(Shape::kHoled, 150, 3);
  const auto a = routing::route(patch.graph), b = routing::route(patch.graph);
  ASSERT_EQ(a.patches.size(), b.patches.size());
  for (std::size_t p = 0; p < a.patches.size(); ++p) {
    ASSERT_EQ(a.patches[p].modules.size(), b.patches[p].modules.size());
    for (std::size_t k = 0; k < a.patches[p].modules.size(); ++k) {
      EXPECT_EQ(a.patches[p].modules[k].node, b.patches[p].modules[k].node);
      EXPECT_EQ(a.patches[p].modules[k].line, b.patches[p].modules[k].line);
      EXPECT_EQ(a.patches[p].modules[k].rotation, b.patches[p].modules[k].rotation);
    }
  }
}

TEST(Routing, mean_loss_of_compact_patches) {
  for (const int n : {142, 232}) {
    const routing::RoutingResult r = routing::route(random_patch(Shape::kCompact, n, 1).graph);
    std::printf("%d modules: extra loss %.3f, one entry %.3f, strapped %.3f, %d without border, %.3f s\n", n,
                r.mean_loss, r.mean_loss_one_entry, r.mean_loss_strapped, r.patches_without_border, r.seconds);
    EXPECT_LE(r.mean_loss, 0.35);
    EXPECT_LE(r.mean_loss, r.mean_loss_one_entry);
    EXPECT_LE(r.mean_loss_one_entry, r.mean_loss_strapped);
  }
}

TEST(Routing, rejects_joints_that_are_not_mutual) {
  design::ModuleGraph graph;
  graph.nodes.resize(2);
  graph.nodes[0].neighbour[0] = 1;
  EXPECT_THROW((void)routing::route(graph), InputError);
  graph.nodes[1].neighbour[0] = graph.nodes[1].neighbour[1] = 0;
  EXPECT_THROW((void)routing::route(graph), InputError);
}

TEST(Routing, rejects_a_capacity_that_the_lines_cannot_carry) {
  routing::RoutingOptions options;
  options.lines = 2;
  EXPECT_THROW((void)routing::route(random_patch(Shape::kCompact, 5, 1).graph, options), InputError);
}

TEST(Routing, a_pair_is_wired_by_hand) {
  // Two tiles have one hop, depth 1 and one line. If the entry fails, a second entry loses only the entry itself.
  const Listed patch = listed({{0, 0, true}, {0, 0, false}});
  const routing::RoutingResult r = routing::route(patch.graph);
  ASSERT_EQ(r.patches.size(), 1U);
  EXPECT_EQ(r.line_hops, 1);
  EXPECT_EQ(r.max_depth, 1);
  const design::Patch& p = r.patches[0];
  EXPECT_NE(p.second_entry, p.entry);
  ASSERT_EQ(p.failures.size(), 3U);  // There are two modules and one joint.
  for (const auto& f : p.failures) EXPECT_EQ(f.lost_backed_up, f.other_node < 0 ? 1 : 0);
  EXPECT_DOUBLE_EQ(r.mean_loss, 0.0);
  EXPECT_DOUBLE_EQ(r.mean_loss_one_entry, 2.0 / 3.0);  // The other module is lost when the entry or the joint fails.
}

// Returns the modules that the normal tree with the listed changes still leads to an entry.
int kept_by_backup(const design::Patch& patch, const design::FailureLoss& f) {
  std::map<int, int> parent;
  for (const auto& m : patch.modules) parent[m.node] = m.parent;
  for (const auto& [child, up] : f.backup_tree) parent[child] = up;
  const auto is_dead = [&](int node) { return f.other_node < 0 && node == f.node; };
  const auto is_broken = [&](int child, int up) {
    return f.other_node >= 0 && std::minmax(child, up) == std::minmax(f.node, f.other_node);
  };
  int kept = 0;
  for (const auto& m : patch.modules) {
    int node = m.node;
    while (!is_dead(node) && parent[node] >= 0 && !is_broken(node, parent[node])) node = parent[node];
    kept += !is_dead(node) && parent[node] < 0 ? 1 : 0;
  }
  return kept;
}

TEST(Routing, the_backup_of_a_failure_keeps_what_its_loss_says) {
  int with_second = 0;
  for (const std::uint64_t seed : {1U, 2U, 3U, 4U}) {
    const routing::RoutingResult r = routing::route(random_patch(Shape::kHoled, 150, seed).graph);
    for (const design::Patch& p : r.patches) {
      for (const design::FailureLoss& f : p.failures) {
        EXPECT_EQ(kept_by_backup(p, f), static_cast<int>(p.modules.size()) - f.lost_rerouted)
            << "seed " << seed << " module " << f.node << " other " << f.other_node;
        with_second += f.lost_one_entry > f.lost_rerouted ? 1 : 0;
      }
    }
  }
  EXPECT_GT(with_second, 100);  // The second entry decides in many cases.
}

TEST(Routing, electrical_rule_by_hand) {
  // With 2 modules on one line, 1 joint and 0.5 m: 0.5·60 + 1·2 + 2·10 = 52 pF; R = 2.9 V / 3 mA; t = 0.8473·R·C.
  const routing::RoutingResult r = routing::route(listed({{0, 0, true}, {0, 0, false}}).graph);
  const design::LineElectrical& line = r.patches[0].lines[0];
  EXPECT_DOUBLE_EQ(line.capacitance_pf, 52.0);
  EXPECT_NEAR(line.pull_up_min_ohm, 966.667, 1e-3);
  EXPECT_NEAR(line.rise_time_ns, 42.591, 1e-3);
  EXPECT_DOUBLE_EQ(line.max_bus_hz, 400e3);
  EXPECT_EQ(r.electrical_violations, 0);
}

TEST(Routing, a_long_cable_is_reported) {
  routing::RoutingOptions options;
  options.electrical.cable_m = 8.0;  // The cable alone has 480 pF, above the 366 pF of fast mode.
  const routing::RoutingResult r = routing::route(random_patch(Shape::kCompact, 16, 1).graph, options);
  EXPECT_EQ(r.electrical_violations, 4);
  EXPECT_DOUBLE_EQ(r.patches[0].lines[0].max_bus_hz, 100e3);
}

}  // namespace
}  // namespace triskin::testing
