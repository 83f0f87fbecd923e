// SPDX-License-Identifier: GPL-3.0-or-later
// Tests which modules of a neighbour a controller adopts, on small patches worked by hand. Modules of the patch come
// first in the joints, then those of the neighbour, whose controller, if there is one, is number 1.
#include <gtest/gtest.h>

#include <set>

#include "random_patch.hpp"

namespace triskin::test {
namespace {

using Look = fw::Topology::Look;
constexpr std::uint8_t kA = 0, kB = 1, kC = 2;

/// Lists joints by hand: "module a, port p to module b, port q".
class Joints {
 public:
  explicit Joints(int modules) : ends_(static_cast<std::size_t>(modules)) {}
  Joints& join(int a, int p, int b, int q) {
    ends_[static_cast<std::size_t>(a)][static_cast<std::size_t>(p)] = {layout::TableRow{b}, q};
    ends_[static_cast<std::size_t>(b)][static_cast<std::size_t>(q)] = {layout::TableRow{a}, p};
    return *this;
  }
  operator const design::PortEnds&() const { return ends_; }  // NOLINT(google-explicit-constructor)

 private:
  design::PortEnds ends_;
};

/// Makes a patch of the first `own` modules, with its cable at module 0 and a table of the joints among them. Without
/// parents the tree is the one of least depth.
class Patch {
 public:
  Patch(const design::PortEnds& joints, int own, int cable_port = kA)
      : model(joints, cable_port, 7), chain(model), topology(chain) {
    table.graph.count = static_cast<std::uint8_t>(own);
    table.graph.cable_port = static_cast<std::uint8_t>(cable_port);
    for (int m = 0; m < own; ++m) {
      const auto k = static_cast<std::size_t>(m);
      table.addresses[k] = {static_cast<std::uint8_t>(m / 4), static_cast<std::uint8_t>(m % 4)};
      for (std::size_t p = 0; p < 3; ++p) {
        const auto e = joints[k][p];
        if (e.row >= 0 && e.row < own)
          table.graph.joint[k][p] = {static_cast<std::uint8_t>(e.row), static_cast<std::uint8_t>(e.port)};
      }
    }
  }
  fw::Topology::Report adopt(std::uint8_t layers = fw::Topology::kAllLayers) {
    return topology.reroute(table, Look::kAdopt, layers);
  }
  [[nodiscard]] std::vector<wire::AdoptedModule> adopted_modules() const {
    std::vector<wire::AdoptedModule> list;
    for (std::uint8_t k = 0; k < topology.adopted_count(); ++k) list.push_back(topology.adopted_module(k));
    return list;
  }
  void expect_at(int module, int place) const {
    EXPECT_TRUE(model.reached(layout::TableRow{module})) << module;
    EXPECT_EQ(4 * model.line_of(layout::TableRow{module}) + model.address_of(layout::TableRow{module}), place)
        << module;
  }

  SwitchedPatch model;
  ModelledChain chain;
  fw::Topology topology;
  fw::Topology::Table table;
};

// 0 – 1 – 2 are joined in a row; the stranger 3 touches 0 and 2. A walk that continued through 3 would reach 2 by a
// joint that the table does not know.
TEST(AdoptedModules, a_way_through_a_stranger_back_into_the_patch_hides_no_own_module) {
  Patch p(Joints(4).join(0, kC, 1, kA).join(1, kB, 2, kA).join(0, kB, 3, kC).join(3, kA, 2, kB), 3);
  const auto report = p.adopt();
  EXPECT_TRUE(report.complete);
  EXPECT_EQ(report.alive, 0b111);
  EXPECT_EQ(report.unknown, 0);
  EXPECT_EQ(p.adopted_modules(), (std::vector<wire::AdoptedModule>{{0, kB, kC, 3}}));
  for (int m = 0; m < 4; ++m) p.expect_at(m, m);
  EXPECT_TRUE(p.topology.intact());
}

// Strangers 1 – 2 – 3 – 4 are in a row behind module 0, and 5 is at its other port.
TEST(AdoptedModules, come_in_layer_by_layer) {
  const Joints joints =
      Joints(6).join(0, kB, 1, kA).join(1, kC, 2, kB).join(2, kA, 3, kA).join(3, kC, 4, kB).join(0, kC, 5, kA);
  Patch p(joints, 1);
  EXPECT_TRUE(p.adopt(1).more_adopted);
  EXPECT_EQ(p.adopted_modules(), (std::vector<wire::AdoptedModule>{{0, kB, kA, 1}, {0, kC, kA, 2}}));
  EXPECT_FALSE(p.model.reached(layout::TableRow{2}));
  EXPECT_TRUE(p.adopt(2).more_adopted);
  EXPECT_EQ(p.adopted_modules().size(), 3U);
  const auto all = p.adopt();
  EXPECT_FALSE(all.more_adopted);
  EXPECT_EQ(all.max_depth, 4);
  EXPECT_EQ(p.adopted_modules(), (std::vector<wire::AdoptedModule>{
                                     {0, kB, kA, 1}, {0, kC, kA, 2}, {1, kC, kB, 3}, {3, kA, kA, 4}, {4, kC, kB, 5}}));
  p.expect_at(4, 5);
  EXPECT_TRUE(p.topology.intact());
}

// 14 rows in a table leave two places. The sixteenth module has a joint to one more, which stays outside.
TEST(AdoptedModules, end_where_the_table_leaves_no_address) {
  Joints joints(17);
  for (int m = 0; m + 1 < 17; ++m) joints.join(m, kB, m + 1, kA);
  Patch p(joints, 14);
  const auto report = p.adopt();
  EXPECT_EQ(report.alive, 0x3FFF);
  EXPECT_FALSE(report.more_adopted);
  EXPECT_EQ(p.adopted_modules(), (std::vector<wire::AdoptedModule>{{13, kB, kA, 14}, {14, kB, kA, 15}}));
  EXPECT_FALSE(p.model.reached(layout::TableRow{16}));
  p.expect_at(15, 15);
  Patch full(joints, 16);
  EXPECT_EQ(full.adopt().alive, 0xFFFF);
  EXPECT_TRUE(full.adopted_modules().empty());
  EXPECT_FALSE(full.model.reached(layout::TableRow{16}));
}

// The stranger 2 holds line 1 low: it stays outside, but 3 beside it is adopted.
TEST(AdoptedModules, one_that_holds_a_line_stays_outside) {
  Patch p(Joints(4).join(0, kB, 1, kA).join(1, kB, 2, kC).join(1, kC, 3, kA), 2);
  p.model.set_stuck_line(layout::TableRow{2}, 1);
  const auto report = p.adopt();
  EXPECT_EQ(report.alive, 0b11);
  EXPECT_EQ(p.adopted_modules(), (std::vector<wire::AdoptedModule>{{1, kC, kA, 2}}));
  EXPECT_FALSE(p.model.reached(layout::TableRow{2}));
  p.model.set_stuck_line(layout::TableRow{2}, -1);
  // The port lies behind an adopted module.
  Patch q(Joints(4).join(0, kB, 1, kA).join(1, kB, 2, kC).join(0, kC, 3, kA), 1);
  q.model.set_stuck_line(layout::TableRow{2}, 1);
  EXPECT_EQ(q.adopt().alive, 0b1);
  EXPECT_EQ(q.adopted_modules(), (std::vector<wire::AdoptedModule>{{0, kB, kA, 1}, {0, kC, kA, 2}}));
  EXPECT_EQ(q.model.stuck_lines(), 0);
}

// A port of an adopted module leads to a fault that breaks the chain in its middle: the modules behind must latch
// nothing of it.
TEST(AdoptedModules, shorts_and_open_ends_behind_a_adopted_cost_no_module) {
  const Joints joints = Joints(5).join(0, kB, 1, kA).join(0, kC, 2, kA).join(1, kB, 3, kA).join(3, kB, 4, kA);
  Patch p(joints, 3);  // Modules 3 and 4 are strangers, and 2 lies behind them in the chain.
  p.model.set_joint({layout::TableRow{3}, kB}, SwitchedPatch::JointFault::kShort);
  EXPECT_EQ(p.adopt().alive, 0b111);
  EXPECT_EQ(p.adopted_modules(), (std::vector<wire::AdoptedModule>{{1, kB, kA, 3}}));
  for (int m = 0; m < 4; ++m) p.expect_at(m, m);
  EXPECT_TRUE(p.topology.intact());
}

TEST(AdoptedModules, are_none_while_an_own_module_is_missing) {
  Patch p(Joints(4).join(0, kB, 1, kA).join(1, kB, 2, kA).join(0, kC, 3, kA), 3);
  p.model.set_dead(layout::TableRow{2}, true);
  EXPECT_EQ(p.adopt().alive, 0b011);
  EXPECT_TRUE(p.adopted_modules().empty());
  p.model.set_dead(layout::TableRow{2}, false);
  EXPECT_EQ(p.adopt().alive, 0b111);
  EXPECT_EQ(p.adopted_modules().size(), 1U);
}

// Module 2 has its own cable at port B and is held by its controller, so it is refused. Once released, it is adopted.
TEST(AdoptedModules, are_none_that_somebody_holds) {
  Patch p(Joints(3).join(0, kB, 1, kA).join(1, kC, 2, kA), 2);
  auto& other = p.model.chain_of(p.model.add_controller({layout::TableRow{2}, kB}));
  other.enable(1);
  EXPECT_EQ(p.adopt().alive, 0b11);
  EXPECT_TRUE(p.adopted_modules().empty());
  EXPECT_EQ(p.model.controller_of(layout::TableRow{2}), 1);
  other.enable(0);
  (void)p.adopt();
  EXPECT_EQ(p.adopted_modules(), (std::vector<wire::AdoptedModule>{{1, kC, kA, 2}}));
  EXPECT_EQ(p.model.controller_of(layout::TableRow{2}), 0);
  // The module is removed while it is adopted: the check detects that, and the own modules continue without it.
  p.model.set_dead(layout::TableRow{2}, true);
  EXPECT_FALSE(p.topology.intact());
  EXPECT_EQ(p.adopt().alive, 0b11);
  EXPECT_TRUE(p.adopted_modules().empty());
}

// The first modules of a random patch are those of the table, the others are strangers.
Patch patch_within(const RandomPatch& r, int own) {
  return {r.joints, own, r.cable_port};
}

TEST(AdoptedModules, are_all_strangers_of_200_random_patches) {
  std::mt19937_64 random(11);
  double slowest_us = 0.0;
  for (int trial = 0; trial < 200; ++trial) {
    const int own = 1 + trial % 12, strangers = 1 + static_cast<int>(random() % 4);
    Patch p = patch_within(random_patch(own + strangers, static_cast<int>(random() % 5), random), own);
    const double start_us = p.model.time_us();
    const auto report = p.adopt();
    slowest_us = std::max(slowest_us, p.model.time_us() - start_us);
    ASSERT_EQ(report.alive, (1U << own) - 1U) << trial;
    ASSERT_EQ(p.topology.adopted_count(), strangers) << trial;
    std::set<int> places;
    for (int m = 0; m < own + strangers; ++m) {
      ASSERT_TRUE(p.model.reached(layout::TableRow{m})) << trial;
      ASSERT_TRUE(
          places.insert(4 * p.model.line_of(layout::TableRow{m}) + p.model.address_of(layout::TableRow{m})).second)
          << trial;
      if (m < own) p.expect_at(m, m);
    }
    EXPECT_TRUE(p.topology.intact());
  }
  EXPECT_LE(slowest_us, 61'000.0);
  std::printf("slowest look with guests: %.1f ms of virtual time\n", slowest_us / 1000);
}

// A marginal clock flips bits: a module that is reported as read must be read at its stated place.
TEST(AdoptedModules, are_never_in_a_wrong_place_where_bits_flip) {
  std::mt19937_64 random(12);
  int complete = 0;
  for (int trial = 0; trial < 200; ++trial) {
    Patch p = patch_within(random_patch(14, 3, random), 10);
    p.model.set_bit_error_rate(2e-5);
    const auto report = p.adopt();
    p.model.set_bit_error_rate(0.0);
    if (!report.complete || !p.topology.intact()) continue;  // The next search has another chance.
    complete += report.alive == 0x3FF && p.topology.adopted_count() == 4 ? 1 : 0;
    for (int m = 0; m < 10; ++m) {
      if ((report.alive >> m & 1) != 0) p.expect_at(m, m);
    }
  }
  EXPECT_GE(complete, 120);
}

}  // namespace
}  // namespace triskin::test
