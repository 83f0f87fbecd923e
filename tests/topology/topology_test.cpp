// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <functional>
#include <map>

#include "random_patch.hpp"

namespace triskin::test {
namespace {

using Fault = SwitchedPatch::JointFault;

std::array<fw::LineAddress, layout::kMaxModules> addresses_of(int modules) {
  std::array<fw::LineAddress, layout::kMaxModules> addresses{};
  // The order is mixed, so that a slot given to the wrong module is detected.
  for (int m = 0; m < modules; ++m) {
    const int s = (7 * m + 3) % 16;
    addresses[static_cast<std::size_t>(m)] = {static_cast<std::uint8_t>(s % 4), static_cast<std::uint8_t>(s / 4)};
  }
  return addresses;
}

struct Failure {
  int module = -1;  // The module is dead, or with `line` holds a line down.
  int line = -1;
  SwitchedPatch::End joint{};  // The joint counts when module < 0.
  Fault fault = Fault::kNone;
};

void apply(SwitchedPatch& model, const Failure& f) {
  if (f.module >= 0 && f.line >= 0)
    model.set_stuck_line(layout::TableRow{f.module}, f.line);
  else if (f.module >= 0)
    model.set_dead(layout::TableRow{f.module}, true);
  else
    model.set_joint(f.joint, f.fault);
}
void repair(SwitchedPatch& model, const Failure& f) {
  if (f.module >= 0 && f.line >= 0)
    model.set_stuck_line(layout::TableRow{f.module}, -1);
  else if (f.module >= 0)
    model.set_dead(layout::TableRow{f.module}, false);
  else
    model.set_joint(f.joint, Fault::kNone);
}

// Returns the best possible depths: least number of joints from the entry over what survives, −1 when there is no
// way.
std::vector<int> best_depths(const RandomPatch& patch, const std::vector<Failure>& failures) {
  const auto dead = [&](int m) {
    return std::any_of(failures.begin(), failures.end(), [&](const Failure& f) { return f.module == m; });
  };
  const auto cut = [&](int m, int p) {
    return std::any_of(failures.begin(), failures.end(), [&](const Failure& f) {
      const auto e = patch.end(m, p);
      return f.module < 0 &&
             ((f.joint.row == m && f.joint.port == p) || (e.row == f.joint.row && e.port == f.joint.port));
    });
  };
  std::vector<int> depth(patch.joints.size(), -1);
  if (dead(0)) return depth;
  depth[0] = 0;
  for (int round = 0; round < patch.size(); ++round) {
    for (int m = 0; m < patch.size(); ++m) {
      for (int p = 0; p < 3; ++p) {
        const int other = patch.end(m, p).row;
        if (depth[static_cast<std::size_t>(m)] != round || other < 0 || dead(other) || cut(m, p) ||
            depth[static_cast<std::size_t>(other)] >= 0)
          continue;
        depth[static_cast<std::size_t>(other)] = round + 1;
      }
    }
  }
  return depth;
}

class Fixture {
 public:
  Fixture(RandomPatch p, std::uint64_t seed)
      : patch(std::move(p)),
        model(patch.joints, patch.cable_port, seed),
        chain(model),
        topology(chain),
        table{table_of(patch), addresses_of(patch.size()), {}} {}

  // Checks after rerouting that exactly the best set is reached, least deep, with each module at its own line and
  // address.
  void expect_best(const std::vector<Failure>& failures) {
    const double start = model.time_us();
    const fw::Topology::Report report = topology.reroute(table);
    slowest_us = std::max(slowest_us, model.time_us() - start);
    const std::vector<int> best = best_depths(patch, failures);
    if (best[0] < 0) {
      EXPECT_FALSE(report.complete);
      EXPECT_EQ(report.alive, 0);
      return;
    }
    ASSERT_TRUE(report.complete);
    ASSERT_TRUE(report.min_depth);
    for (int m = 0; m < patch.size(); ++m) {
      const auto k = static_cast<std::size_t>(m);
      ASSERT_EQ(model.depth_of(layout::TableRow{m}), best[k]) << "module " << m;
      ASSERT_EQ((report.alive >> m & 1) != 0, best[k] >= 0) << "module " << m;
      if (best[k] < 0) continue;
      ASSERT_EQ(model.line_of(layout::TableRow{m}), table.addresses[k].line);
      ASSERT_EQ(model.address_of(layout::TableRow{m}), table.addresses[k].address);
    }
    EXPECT_TRUE(topology.intact());
  }

  RandomPatch patch;
  SwitchedPatch model;
  ModelledChain chain;
  fw::Topology topology;
  fw::Topology::Table table;
  double slowest_us = 0.0;
};

std::vector<Failure> single_failures(const RandomPatch& patch) {
  std::vector<Failure> list;
  for (int m = 0; m < patch.size(); ++m) {
    list.push_back({.module = m});
    if (m > 0) list.push_back({.module = m, .line = m % 4});
  }
  for (const auto e : patch.joint_ends()) {
    list.push_back({.joint = e, .fault = Fault::kOpen});
    list.push_back({.joint = e, .fault = Fault::kShort});
  }
  return list;
}

TEST(Discovery, finds_every_joint_of_1000_random_patches_within_50_ms) {
  std::mt19937_64 random(1);
  double slowest_us = 0.0;
  int cycles_seen = 0;
  for (int trial = 0; trial < 1000; ++trial) {
    const int modules = 1 + trial % 16;
    Fixture fixture(random_patch(modules, static_cast<int>(random() % 5), random), random());
    const fw::Topology::Report report = fixture.topology.discover();
    ASSERT_TRUE(report.complete) << trial;
    ASSERT_EQ(report.shorts, 0);
    ASSERT_TRUE(canonical(fixture.topology.graph()) == canonical(fixture.table.graph)) << trial;
    cycles_seen += static_cast<int>(fixture.patch.joint_ends().size()) - modules + 1;
    slowest_us = std::max(slowest_us, fixture.model.time_us());
  }
  EXPECT_LE(slowest_us, 50'000.0);
  EXPECT_GE(cycles_seen, 1000);
  RecordProperty("slowest_us", static_cast<int>(slowest_us));
  std::printf("slowest discovery: %.1f ms of virtual time, %d cycles in all\n", slowest_us / 1000, cycles_seen);
}

// Without a table nothing tells where the patch ends. Each port behind which was a seventeenth module used to restart
// the search.
TEST(Discovery, of_a_patch_that_is_joined_to_others_takes_sixteen_modules_within_60_ms) {
  std::mt19937_64 random(9);
  double slowest_us = 0.0;
  for (int trial = 0; trial < 200; ++trial) {
    const RandomPatch patch = random_patch(40, static_cast<int>(random() % 20), random);
    SwitchedPatch model(patch.joints, patch.cable_port, random());
    ModelledChain chain(model);
    fw::Topology topology(chain);
    const fw::Topology::Report report = topology.discover();
    ASSERT_TRUE(report.complete) << trial;
    ASSERT_EQ(report.shorts, 0) << trial;
    ASSERT_EQ(topology.graph().count, layout::kMaxModules) << trial;
    slowest_us = std::max(slowest_us, model.time_us());
    int reached = 0;
    for (int m = 0; m < patch.size(); ++m) reached += model.reached(layout::TableRow{m}) ? 1 : 0;
    ASSERT_GE(reached, 1) << trial;
    topology.let_go();
    for (int m = 0; m < patch.size(); ++m) ASSERT_FALSE(model.reached(layout::TableRow{m})) << trial;
  }
  EXPECT_LE(slowest_us, 60'000.0);
  std::printf("slowest look beyond a border: %.1f ms of virtual time\n", slowest_us / 1000);
}

TEST(Discovery, of_nothing_and_of_one_module) {
  std::mt19937_64 random(2);
  Fixture one(random_patch(1, 0, random), 1);
  EXPECT_TRUE(one.topology.discover().complete);
  EXPECT_EQ(one.topology.graph().count, 1);
  one.model.set_dead(layout::TableRow{0}, true);
  EXPECT_FALSE(one.topology.discover().complete);
  EXPECT_EQ(one.topology.graph().count, 0);
}

TEST(Healing, every_single_failure_of_200_patches_ends_at_the_best_possible_within_100_ms) {
  std::mt19937_64 random(3);
  double slowest_us = 0.0;
  int failures = 0;
  for (int trial = 0; trial < 200; ++trial) {
    Fixture fixture(random_patch(2 + trial % 15, static_cast<int>(random() % 5), random), random());
    fixture.expect_best({});
    for (const Failure& f : single_failures(fixture.patch)) {
      apply(fixture.model, f);
      ASSERT_NO_FATAL_FAILURE(fixture.expect_best({f})) << trial;
      repair(fixture.model, f);
      ++failures;
    }
    ASSERT_NO_FATAL_FAILURE(fixture.expect_best({})) << "after repair";
    slowest_us = std::max(slowest_us, fixture.slowest_us);
  }
  EXPECT_LE(slowest_us, 100'000.0);
  std::printf("%d failures, slowest healing: %.1f ms of virtual time\n", failures, slowest_us / 1000);
}

TEST(Healing, any_two_failures_end_at_the_best_possible) {
  std::mt19937_64 random(4);
  for (int trial = 0; trial < 12; ++trial) {
    Fixture fixture(random_patch(5 + trial, static_cast<int>(random() % 5), random), random());
    const auto list = single_failures(fixture.patch);
    for (std::size_t a = 0; a < list.size(); ++a) {
      for (std::size_t b = a + 1; b < list.size(); ++b) {
        if (random() % 3 != 0) continue;
        if (list[a].module == list[b].module && list[a].module >= 0) continue;
        if (list[a].module < 0 && list[b].module < 0 && list[a].joint.row == list[b].joint.row &&
            list[a].joint.port == list[b].joint.port)
          continue;
        apply(fixture.model, list[a]);
        apply(fixture.model, list[b]);
        ASSERT_NO_FATAL_FAILURE(fixture.expect_best({list[a], list[b]})) << trial << ' ' << a << ' ' << b;
        repair(fixture.model, list[a]);
        repair(fixture.model, list[b]);
      }
    }
  }
}

// The next check sees a failure between two checks, so that no sample of that cycle counts.
TEST(Healing, the_check_sees_every_loss_and_a_module_that_resets_alone) {
  std::mt19937_64 random(5);
  for (int trial = 0; trial < 100; ++trial) {
    Fixture fixture(random_patch(2 + trial % 15, 2, random), random());
    fixture.expect_best({});
    for (int m = 0; m < fixture.patch.size(); ++m) {
      fixture.model.reset_alone(layout::TableRow{m});
      EXPECT_FALSE(fixture.topology.intact());
      fixture.expect_best({});
      fixture.model.set_dead(layout::TableRow{m}, true);
      EXPECT_FALSE(fixture.topology.intact());
      fixture.model.set_dead(layout::TableRow{m}, false);
      fixture.expect_best({});
    }
  }
}

// While the tree changes, no two modules that the lines reach hold the same slot, except those that have none yet.
TEST(Healing, no_two_configured_modules_share_a_slot_at_any_latch) {
  std::mt19937_64 random(6);
  for (int trial = 0; trial < 100; ++trial) {
    Fixture fixture(random_patch(3 + trial % 14, 3, random), random());
    fixture.chain.watch = [&] {
      std::map<int, int> users;
      for (int m = 0; m < fixture.patch.size(); ++m) {
        const int slot = fixture.model.line_of(layout::TableRow{m}) * 4 + fixture.model.address_of(layout::TableRow{m});
        if (fixture.model.reached(layout::TableRow{m}) && slot != 0) ++users[slot];
      }
      for (const auto& [slot, count] : users) EXPECT_EQ(count, 1) << "slot " << slot;
    };
    fixture.expect_best({});
  }
}

TEST(Faults, stuck_register_bits_end_in_bounded_time_without_a_wrong_map) {
  std::mt19937_64 random(7);
  for (int trial = 0; trial < 60; ++trial) {
    Fixture fixture(random_patch(2 + trial % 15, 3, random), random());
    for (int m = 0; m < fixture.patch.size(); ++m) {
      for (const int bit : {4, 5, 6}) {
        fixture.model.set_stuck_bit(layout::TableRow{m}, bit, 0);
        const double start = fixture.model.time_us();
        const auto report = fixture.topology.reroute(fixture.table);
        EXPECT_LE(fixture.model.time_us() - start, 2'000'000.0);
        for (int k = 0; k < fixture.patch.size(); ++k) {
          if ((report.alive >> k & 1) == 0) continue;
          ASSERT_TRUE(fixture.model.reached(layout::TableRow{k}))
              << "trial " << trial << ": bit " << bit << " of " << m << ", module " << k << " of "
              << fixture.patch.size() << ", table " << report.alive << ", cable " << fixture.patch.cable_port;
          ASSERT_EQ(fixture.model.line_of(layout::TableRow{k}),
                    fixture.table.addresses[static_cast<std::size_t>(k)].line);
          ASSERT_EQ(fixture.model.address_of(layout::TableRow{k}),
                    fixture.table.addresses[static_cast<std::size_t>(k)].address);
        }
        fixture.model.set_stuck_bit(layout::TableRow{m}, bit, -1);
      }
    }
  }
}

TEST(Faults, a_marginal_chain_clock_gives_no_wrong_joint) {
  std::mt19937_64 random(8);
  int complete = 0;
  for (int trial = 0; trial < 200; ++trial) {
    Fixture fixture(random_patch(2 + trial % 15, 3, random), random());
    fixture.model.set_bit_error_rate(2e-5);
    const auto report = fixture.topology.discover();
    if (!report.complete || report.shorts > 0) continue;
    ++complete;
    EXPECT_TRUE(canonical(fixture.topology.graph()) == canonical(fixture.table.graph)) << trial;
  }
  EXPECT_GE(complete, 150);
}

}  // namespace
}  // namespace triskin::test
