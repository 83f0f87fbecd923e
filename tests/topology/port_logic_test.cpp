// SPDX-License-Identifier: GPL-3.0-or-later
// Visits every state that modules of small patches can reach, with gates acting in any order and any bits latched at
// any time.
#include "triskin/sim/port_logic.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cstdint>
#include <unordered_set>
#include <vector>

namespace triskin::test {
namespace {

struct Wire {
  int module = -1, port = 0;
};
using Patch = std::vector<std::array<Wire, 3>>;

struct State {
  struct One {
    std::uint8_t enable = 0;
    int grant = sim::kNoGrant;
  };
  std::array<One, 4> module{};
  std::uint32_t cables = 0;  // Bit c is EN of cable c.
  [[nodiscard]] std::uint32_t key() const {
    std::uint32_t k = cables;
    for (const One& m : module) k = k << 5 | static_cast<std::uint32_t>(m.enable << 2 | m.grant);
    return k;
  }
};

// Each cable belongs to another controller.
class Explorer {
 public:
  explicit Explorer(Patch patch, std::vector<Wire> cables = {{0, 0}})
      : patch_(std::move(patch)), cables_(std::move(cables)) {}

  std::size_t run() {
    visit(State{});
    while (!queue_.empty()) {
      const State s = queue_.back();
      queue_.pop_back();
      expect_one_path(s);
      for (std::size_t c = 0; c < cables_.size(); ++c) {
        State other = s;
        other.cables ^= 1U << c;
        visit(other);
      }
      for (std::size_t m = 0; m < patch_.size(); ++m) {
        gates(s, m);
        if (!from_controller(s, static_cast<int>(m))) continue;
        for (std::uint8_t bits = 0; bits < 8; ++bits) {  // A latch pulse may write any of these values.
          State next = s;
          next.module[m].enable = bits;
          visit(next);
        }
      }
      if (testing::Test::HasFailure()) break;
    }
    return seen_.size();
  }

 private:
  [[nodiscard]] sim::PortInputs inputs(const State& s, std::size_t m) const {
    sim::PortInputs in{s.module[m].enable, 0, s.module[m].grant};
    for (std::size_t c = 0; c < cables_.size(); ++c) {
      if ((s.cables >> c & 1) != 0 && cables_[c].module == static_cast<int>(m))
        in.en_in = static_cast<std::uint8_t>(in.en_in | 1U << cables_[c].port);
    }
    for (std::size_t p = 0; p < 3; ++p) {
      const Wire w = patch_[m][p];
      if (w.module < 0) continue;
      const auto& other = s.module[static_cast<std::size_t>(w.module)];
      if ((sim::en_out(other.grant, other.enable) >> w.port & 1) != 0)
        in.en_in = static_cast<std::uint8_t>(in.en_in | 1U << p);
    }
    return in;
  }
  [[nodiscard]] bool closed(const State& s, int m, int p) const {
    return (sim::switches(inputs(s, static_cast<std::size_t>(m))) >> p & 1) != 0;
  }
  // Returns true if the switches of a joint are closed at both ends.
  [[nodiscard]] bool conducts(const State& s, int m, int p) const {
    const Wire w = patch_[static_cast<std::size_t>(m)][static_cast<std::size_t>(p)];
    return w.module >= 0 && closed(s, m, p) && closed(s, w.module, w.port);
  }
  [[nodiscard]] bool from_controller(const State& s, int m) const {
    for (std::size_t steps = 0; steps <= patch_.size(); ++steps) {
      const int g = s.module[static_cast<std::size_t>(m)].grant;
      if (g == sim::kNoGrant) return false;
      for (std::size_t c = 0; c < cables_.size(); ++c) {
        if (cables_[c].module == m && cables_[c].port == g) return (s.cables >> c & 1) != 0;
      }
      if (!conducts(s, m, g)) return false;
      m = patch_[static_cast<std::size_t>(m)][static_cast<std::size_t>(g)].module;
    }
    return false;
  }
  void gates(const State& s, std::size_t m) {
    const sim::PortInputs in = inputs(s, m);
    State next = s;
    if (sim::loses_grant(in)) {
      next.module[m] = {};
      visit(next);
      return;
    }
    for (int p = 0; p < 3; ++p) {
      if ((sim::may_be_granted(in) >> p & 1) == 0) continue;
      next.module[m] = {0, p};
      visit(next);
    }
  }
  // Expects as many conducting joints on the paths from a cable as modules reached besides the first, so that none has
  // two ways, and no module that two cables reach.
  void expect_one_path(const State& s) const {
    std::vector<bool> in(patch_.size(), false);
    for (std::size_t c = 0; c < cables_.size(); ++c) {
      if ((s.cables >> c & 1) != 0 && closed(s, cables_[c].module, cables_[c].port))
        walk_from(s, cables_[c].module, in);
    }
  }
  void walk_from(const State& s, int first, std::vector<bool>& in) const {
    EXPECT_FALSE(in[static_cast<std::size_t>(first)]);
    std::vector<int> reached{first};
    in[static_cast<std::size_t>(first)] = true;
    std::size_t ends = 0;
    for (std::size_t k = 0; k < reached.size(); ++k) {
      for (int p = 0; p < 3; ++p) {
        if (!conducts(s, reached[k], p)) continue;
        ++ends;
        const int other = patch_[static_cast<std::size_t>(reached[k])][static_cast<std::size_t>(p)].module;
        if (in[static_cast<std::size_t>(other)]) continue;
        in[static_cast<std::size_t>(other)] = true;
        reached.push_back(other);
      }
    }
    EXPECT_EQ(ends, 2 * (reached.size() - 1));
  }
  void visit(const State& s) {
    if (seen_.insert(s.key()).second) queue_.push_back(s);
  }

  Patch patch_;
  std::vector<Wire> cables_;
  std::unordered_set<std::uint32_t> seen_;
  std::vector<State> queue_;
};

TEST(PortLogic, no_reachable_state_of_a_triangle_of_modules_has_two_paths) {
  const Patch triangle{{{{-1, 0}, {1, 0}, {2, 0}}}, {{{0, 1}, {2, 1}, {-1, 0}}}, {{{0, 2}, {1, 1}, {-1, 0}}}};
  EXPECT_GT(Explorer(triangle).run(), 500U);
}

TEST(PortLogic, no_reachable_state_of_two_modules_with_two_joints_has_two_paths) {
  const Patch doubled{{{{-1, 0}, {1, 0}, {1, 1}}}, {{{0, 1}, {0, 2}, {-1, 0}}}};
  EXPECT_GT(Explorer(doubled).run(), 50U);
}

TEST(PortLogic, no_reachable_state_of_four_modules_with_every_possible_joint_has_two_paths) {
  // The joints 0-1, 0-2, 1-2, 1-3, 2-3 form two cycles; port 0 of module 0 is the cable.
  const Patch four{
      {{{-1, 0}, {1, 0}, {2, 0}}}, {{{0, 1}, {2, 1}, {3, 0}}}, {{{0, 2}, {1, 1}, {3, 1}}}, {{{1, 2}, {2, 2}, {-1, 0}}}};
  EXPECT_GT(Explorer(four).run(), 5000U);
}

// The joint of 1 and 2 is the border of two patches, and each controller may open it from its side at any time.
TEST(PortLogic, no_reachable_state_of_two_controllers_joins_their_lines) {
  const Patch row{{{{-1, 0}, {1, 0}, {-1, 0}}},
                  {{{0, 1}, {2, 0}, {-1, 0}}},
                  {{{1, 1}, {3, 0}, {-1, 0}}},
                  {{{2, 1}, {-1, 0}, {-1, 0}}}};
  EXPECT_GT(Explorer(row, {{0, 0}, {3, 1}}).run(), 5000U);
  const Patch ring{
      {{{-1, 0}, {1, 0}, {2, 0}}}, {{{0, 1}, {2, 1}, {3, 0}}}, {{{0, 2}, {1, 1}, {3, 1}}}, {{{1, 2}, {2, 2}, {-1, 0}}}};
  EXPECT_GT(Explorer(ring, {{0, 0}, {3, 2}}).run(), 20000U);
}

// These rows of the truth table in docs/switched_module.md are worked by hand.
TEST(PortLogic, truth_table) {
  using sim::PortInputs;
  EXPECT_EQ(sim::en_out(sim::kNoGrant, 7), 0);                         // Without a parent everything is closed.
  EXPECT_EQ(sim::en_out(0, 7), 6);                                     // The parent's own port is never driven.
  EXPECT_EQ(sim::switches({.enable = 2, .en_in = 1, .grant = 0}), 3);  // The parent and the opened port are set.
  EXPECT_EQ(sim::switches({.enable = 2, .en_in = 3, .grant = 0}), 1);  // Both ends open one joint, so it stays cut.
  EXPECT_EQ(sim::switches({.enable = 7, .en_in = 7, .grant = sim::kNoGrant}), 0);
  EXPECT_TRUE(sim::loses_grant({.enable = 0, .en_in = 6, .grant = 0}));
  EXPECT_FALSE(sim::loses_grant({.enable = 0, .en_in = 1, .grant = 0}));
  EXPECT_EQ(sim::may_be_granted({.enable = 0, .en_in = 6, .grant = 0}), 0);  // A second EN is refused.
}

}  // namespace
}  // namespace triskin::test
