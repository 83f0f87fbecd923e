// SPDX-License-Identifier: GPL-3.0-or-later
// Tests many controllers: addresses without collisions, parallel tasks, several links as one.
#include <gtest/gtest.h>

#include <deque>
#include <set>

#include "support/device_fixture.hpp"
#include "support/faulty_link.hpp"
#include "triskin/link/combined_link.hpp"
#include "triskin/session/controller.hpp"
#include "triskin/session/patch_table.hpp"
#include "triskin/session/scheduler.hpp"

namespace triskin::session {

using test::FaultyLink;
using test::Fixture;
using test::taking_over;

namespace {

// Simulates controllers that each seem to have their own wire, as USB devices do, with a delay for frames of the host.
class Star final : public link::Link {
 public:
  Star(link::Link& inner, bool one_wire = false) : inner_(inner), one_wire_(one_wire) {}
  void send(const wire::CanFrame& frame) override { out_.emplace_back(now_us() + kWay_us, frame); }
  std::optional<wire::CanFrame> receive(std::uint64_t until_us) override {
    while (true) {
      for (; !out_.empty() && out_.front().first <= now_us(); out_.pop_front()) inner_.send(out_.front().second);
      if (auto frame = inner_.receive(out_.empty() ? until_us : std::min(until_us, out_.front().first))) return frame;
      if (now_us() >= until_us) return std::nullopt;
    }
  }
  [[nodiscard]] std::uint64_t now_us() const override { return inner_.now_us(); }
  [[nodiscard]] bool fd() const override { return inner_.fd(); }
  [[nodiscard]] std::uint64_t answer_us() const override { return inner_.answer_us(); }
  [[nodiscard]] std::string name() const override { return "star"; }
  [[nodiscard]] int wire_of(std::uint8_t node) const override { return one_wire_ ? 0 : node; }

 private:
  static constexpr std::uint64_t kWay_us = 2'000;
  link::Link& inner_;
  const bool one_wire_;
  std::deque<std::pair<std::uint64_t, wire::CanFrame>> out_;
};

void expect_tables(Fixture& fixture) {
  std::set<int> addresses;
  for (const auto& c : fixture.bus().discover()) addresses.insert(c.node_address);
  EXPECT_EQ(addresses.size(), fixture.design().patches.size());
  for (std::size_t p = 0; p < fixture.design().patches.size(); ++p) {
    const auto image = bytes_of(image_of(fixture.design(), layout::PatchIndex{p}));
    EXPECT_EQ(Controller(fixture.bus(), static_cast<std::uint8_t>(p + 1)).read_table(image.size()), image) << p;
  }
}

TEST(Addresses, sixteen_fresh_boards_with_one_default_address_get_one_each) {
  Fixture fixture(32, 2);
  const auto fresh = fixture.bus().discover();
  ASSERT_EQ(fresh.size(), 16U);
  std::set<std::uint32_t> ids;
  for (const auto& c : fresh) {
    EXPECT_EQ(c.node_address, 1);
    ids.insert(wire::claim_id(c.unique_id));
  }
  EXPECT_EQ(ids.size(), 16U);  // Different ids keep their claims from colliding on the bus.
  EXPECT_EQ(fixture.flash().patches.size(), 16U);
  expect_tables(fixture);
  EXPECT_EQ(fixture.flash().skipped, 16);
}

TEST(Addresses, sixteen_fresh_boards_on_a_bus_that_loses_and_delays_frames) {
  for (unsigned seed = 1; seed <= 8; ++seed) {
    Fixture fixture(32, 2);
    FaultyLink wire(fixture.bus().link(), false, {1, 1, 1, 0}, seed);
    Bus bus(wire);
    bool completed = false;
    std::string last;  // The last attempt gave this message.
    for (int attempt = 0; attempt < 60 && !completed; ++attempt) {
      try {
        completed = deploy::flash(bus, fixture.design()).patches.size() == 16;
      } catch (const DeviceError& e) {
        last = e.what();
      }
    }
    ASSERT_TRUE(completed) << "seed " << seed << ": " << last;
    fixture.bus().listen(fixture.bus().now_us() + 1'500'000);
    expect_tables(fixture);
  }
}

// 126 claims of two frames each take longer than the window for the first one.
TEST(Addresses, all_boards_of_a_slow_bus_are_found) {
  for (const std::uint64_t bit_rate : {1'000'000U, 250'000U, 125'000U, 50'000U}) {
    hardware::Scene scene;
    scene.design = test::strip(126, 1);
    scene.effects.bus_bit_rate = bit_rate;
    hardware::SimLink sim(std::move(scene));
    FaultyLink classic(sim, false, {}, 1);  // The link injects no faults: it only restricts the bus to classic frames.
    Bus bus(classic);
    EXPECT_EQ(bus.discover().size(), 126U) << bit_rate << " bit/s";
  }
}

TEST(SideBySide, controllers_on_wires_of_their_own_are_flashed_at_the_same_time) {
  Fixture one_by_one(32, 2), together(32, 2);
  Star line(one_by_one.bus().link(), true), star(together.bus().link());
  Bus line_bus(line), bus(star);
  deploy::FlashOptions one;
  one.per_wire = 1;
  const double slow_s = flash(line_bus, one_by_one.design(), one).link_s,
               fast_s = deploy::flash(bus, together.design()).link_s;
  expect_tables(together);
  EXPECT_LT(fast_s, 0.5 * slow_s);
  const diagnose::VerifyOptions ask_only{};
  EXPECT_TRUE(verify(bus, together.design(), ask_only).findings.empty());
  std::printf("16 controllers: %.3f s one after the other, %.3f s side by side (virtual time)\n", slow_s, fast_s);
}

TEST(SideBySide, the_order_is_the_same_every_time) {
  const auto run = [] {
    Fixture fixture(32, 2);
    Star star(fixture.bus().link());
    FaultyLink wire(star, false, {1, 1, 1, 1}, 5);
    Bus bus(wire);
    try {
      (void)deploy::flash(bus, fixture.design());
    } catch (const DeviceError& e) {
      return std::pair(wire.frames, std::string(e.what()));
    }
    return std::pair(wire.frames, std::string());
  };
  EXPECT_EQ(run(), run());
}

TEST(SideBySide, one_that_fails_does_not_keep_the_others_from_their_tables) {
  Fixture fixture(12, 4);
  (void)fixture.flash();  // This assigns all addresses.
  design::Design other = fixture.design();
  for (auto& p : other.patches) std::swap(p.modules[1].address, p.modules[2].address);
  other.design_id = design::design_id_of(other);
  (void)flash(fixture.bus(), other, taking_over());
  Star star(fixture.bus().link());
  fixture.skin().flash(1).cut_power_after(3, hardware::FlashMemory::Tear::kHalf);
  Bus bus(star);
  try {
    (void)flash(bus, fixture.design(), taking_over());
    FAIL() << "a dead controller was flashed";
  } catch (const DeviceError& e) {
    EXPECT_NE(std::string(e.what()).find("controller 2 does not answer"), std::string::npos) << e.what();
    EXPECT_NE(std::string(e.what()).find("2 of 3 controllers have their table (patches 0, 2)"), std::string::npos)
        << e.what();
  }
}

TEST(SideBySide, outcomes_have_the_order_of_the_tasks) {
  Fixture fixture(12, 4);
  fixture.flash();
  std::vector<int> began;
  std::vector<Task> tasks;
  for (std::uint8_t node = 1; node <= 3; ++node) {
    tasks.push_back({node, [&began, node](Bus& bus) {
                       began.push_back(node);
                       (void)Controller(bus, node).hello();
                       if (node == 2) throw DeviceError("two");
                     }});
  }
  const auto outcomes = run_tasks(fixture.bus().link(), tasks);
  EXPECT_EQ(began, (std::vector<int>{1, 2, 3}));
  ASSERT_EQ(outcomes.size(), 3U);
  EXPECT_FALSE(outcomes[0]);
  EXPECT_FALSE(outcomes[2]);
  EXPECT_THROW(std::rethrow_exception(outcomes[1]), DeviceError);
  EXPECT_TRUE(run_tasks(fixture.bus().link(), {}).empty());
}

std::unique_ptr<hardware::SimLink> simulated(int modules) {
  hardware::Scene scene;
  scene.design = test::strip(modules);
  return std::make_unique<hardware::SimLink>(std::move(scene));
}

TEST(CombinedLink, a_design_goes_to_controllers_on_two_links) {
  auto first = simulated(8), second = simulated(6);
  Bus first_bus(*first), second_bus(*second);
  std::vector<std::unique_ptr<link::Link>> links;
  hardware::SimLink &a = *first, &b = *second;
  links.push_back(std::move(first));
  links.push_back(std::move(second));
  link::CombinedLink both(std::move(links));
  Bus bus(both);
  const design::Design design = test::strip(12, 6);
  const deploy::FlashResult r = deploy::flash(bus, design);
  EXPECT_EQ(r.patches.size(), 2U);
  EXPECT_NE(both.wire_of(1), both.wire_of(2));
  EXPECT_EQ(both.name(), "sim,sim");
  std::set<int> nodes;
  for (hardware::SimLink* link : {&a, &b}) {
    Bus own(*link);
    const auto claims = own.discover();
    ASSERT_EQ(claims.size(), 1U);
    EXPECT_EQ(Controller(own, claims[0].node_address).active_table().design_id, design.design_id);
    nodes.insert(claims[0].node_address);
  }
  EXPECT_EQ(nodes, (std::set<int>{1, 2}));
}

TEST(NodeMap, learns_from_claims_and_answers_and_forgets_when_addresses_change) {
  link::NodeMap map;
  const wire::UniqueId first{1}, second{2};
  const auto hear = [&](const wire::UniqueId& id, std::uint8_t node, int wire) {
    for (const auto& f : wire::encode_claim({id, node, false})) map.heard(f, wire);
  };
  hear(first, 1, 10);
  EXPECT_EQ(map.wire_of(1), 10);
  hear(second, 1, 11);
  EXPECT_FALSE(map.wire_of(1));  // The two boards are fresh.
  map.sent(wire::encode_assignment(second, 2)[0]);
  EXPECT_FALSE(map.wire_of(1));
  wire::CanFrame answer;
  answer.extended = true;
  answer.id = wire::physical_id(wire::kTesterAddress, 2);
  map.heard(answer, 11);
  EXPECT_EQ(map.wire_of(2), 11);
  wire::CanFrame request;
  request.extended = true;
  request.id = wire::physical_id(2, wire::kTesterAddress);
  EXPECT_EQ(link::NodeMap::target_of(request), 2);
  EXPECT_FALSE(link::NodeMap::target_of(answer));
  map.sent(wire::who_is_there());
  EXPECT_FALSE(map.wire_of(2));
}

}  // namespace
}  // namespace triskin::session
