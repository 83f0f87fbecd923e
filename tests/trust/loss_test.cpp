// SPDX-License-Identifier: GPL-3.0-or-later
// Every sample that was due must be received, or counted as lost at a named place.
#include <gtest/gtest.h>

#include "shared_skin.hpp"
#include "triskin/session/controller.hpp"
#include "triskin/session/stream.hpp"
#include "triskin/wire/bus_load.hpp"

namespace triskin::deploy {
namespace {

using test::kSequence_us;
using test::SampleName;
using test::SharedSkin;
using test::strip_scene;

// 193 modules on 13 controllers share one bus with 1 Mbit/s and 2 Mbit/s data: 163 % of it.
class Crowded : public testing::Test {
 protected:
  Crowded() { hub_.flash(); }
  // Streams for `seconds` and keeps the samples.
  session::StreamReport run(double seconds, session::StreamOptions options) {
    hub_.forget();
    session::Stream stream(
        bus_, hub_.design(),
        [&](const session::ModuleSample& f) {
          came_.insert({f.sample.node_address, f.sample.module, f.sample.sample});
        },
        std::move(options));
    stream.run_until(bus_.now_us() + static_cast<std::uint64_t>(seconds * 1e6));
    stream.finish();
    return stream.report();
  }
  // For each module, every sample that was on the bus between the first and the last received one must be received.
  void expect_as_on_the_bus() const {
    std::map<std::pair<int, int>, std::pair<std::uint32_t, std::uint32_t>> range;
    for (const SampleName& s : came_) {
      auto& [low, high] = range.try_emplace({s.node, s.row}, s.number, s.number).first->second;
      low = std::min(low, s.number);
      high = std::max(high, s.number);
    }
    std::set<SampleName> truth;
    for (const SampleName& s : hub_.on_bus()) {
      const auto r = range.find({s.node, s.row});
      if (r != range.end() && s.number >= r->second.first && s.number <= r->second.second) truth.insert(s);
    }
    EXPECT_EQ(truth, came_);
  }

  SharedSkin hub_{strip_scene(193, 16, 1'000'000, 2'000'000)};
  SharedSkin::Client link_{hub_};
  session::Bus bus_{link_};
  std::set<SampleName> came_;
};

// The report used to be "31312 module samples, 0 lost", status 0, while 76 of 193 modules were not in the file. Now
// every sample is still requested, and each missing one is counted.
TEST_F(Crowded, a_bus_that_is_too_slow_is_said_and_every_module_gets_its_share) {
  session::StreamOptions options;
  options.every = 1;
  options.overload = true;
  const session::StreamReport r = run(10.0, options);
  EXPECT_NEAR(static_cast<double>(r.total.expected), 193 * 10e6 / kSequence_us, 0.02 * 193 * 10e6 / kSequence_us);
  EXPECT_EQ(r.total.received, came_.size());
  EXPECT_EQ(r.total.expected, r.total.received + r.total.unread + r.total.dropped + r.total.on_the_way);
  EXPECT_EQ(r.total.on_the_way, 0U);
  EXPECT_GT(r.total.dropped, r.total.expected / 3);
  expect_as_on_the_bus();
  EXPECT_FALSE(r.complete());
  EXPECT_TRUE(r.never_heard.empty());
  EXPECT_EQ(r.starved.size(), 13U);
  std::uint64_t least = UINT64_MAX, most = 0;
  for (const session::ModuleCounts& m : r.modules) {
    least = std::min(least, m.counts.received);
    most = std::max(most, m.counts.received);
  }
  EXPECT_EQ(r.modules.size(), 193U);
  EXPECT_GE(static_cast<double>(least), 0.95 * static_cast<double>(most)) << least << " … " << most;
  const std::string text = session::sentences(r).at(1);
  EXPECT_NE(text.find("patches 0–12"), std::string::npos) << text;
  EXPECT_NE(text.find("% of the bus"), std::string::npos) << text;
  EXPECT_NE(text.find("--every 2"), std::string::npos) << text;
  EXPECT_NE(text.find("second bus"), std::string::npos) << text;
}

TEST_F(Crowded, what_does_not_fit_is_refused_and_a_rate_that_fits_is_chosen) {
  session::StreamOptions asked;
  asked.every = 1;
  EXPECT_THROW((void)run(0.1, asked), InputError);
  std::string said;
  session::StreamOptions chosen;
  chosen.say = [&](const std::string& text) { said += text; };
  const session::StreamReport r = run(4.0, chosen);
  EXPECT_EQ(r.budget.every, 2);
  EXPECT_TRUE(r.complete()) << session::sentences(r).at(0);
  EXPECT_NEAR(static_cast<double>(r.total.received), 193 * 4e6 / kSequence_us / 2, 200);
  EXPECT_NE(said.find("% of the bus"), std::string::npos) << said;
  expect_as_on_the_bus();
}

TEST(Loss, what_the_computer_loses_is_counted_by_the_frame) {
  SharedSkin hub(strip_scene(6, 3));
  hub.flash();
  SharedSkin::Client link(hub);
  session::Bus bus(link);
  std::map<std::uint32_t, std::uint64_t> lost;  // The key is the identifier.
  int turn = 0;
  link.lose = [&](const wire::CanFrame& f) { return wire::decode_full(f) && ++turn % 7 == 0 && ++lost[f.id] > 0; };
  session::Stream stream(bus, hub.design(), {});
  lost.clear();
  stream.run_until(bus.now_us() + 2'000'000);
  stream.finish();
  const session::StreamReport r = stream.report();
  EXPECT_GT(r.total.on_the_way, 20U);
  EXPECT_EQ(r.lost_bus, r.total.on_the_way);
  EXPECT_EQ(r.total.dropped + r.total.unread + r.total.silent, 0U);
  for (const session::ModuleCounts& m : r.modules) {
    const std::uint32_t id =
        wire::kFullBase | static_cast<std::uint32_t>(m.patch + 1) << 8 | static_cast<std::uint32_t>(m.module % 3);
    // A frame that was lost before the lease began, or after its end, does not belong to its samples.
    EXPECT_LE(m.counts.on_the_way, lost[id]) << m.module;
    EXPECT_GE(m.counts.on_the_way + 2, lost[id]) << m.module;
  }
  EXPECT_FALSE(r.complete());
}

TEST(Loss, frames_that_the_computer_threw_away_are_its_own) {
  SharedSkin hub(strip_scene(3, 3));
  hub.flash();
  SharedSkin::Client link(hub);
  session::Bus bus(link);
  session::Stream stream(bus, hub.design(), {});
  link.count = true;
  int turn = 0;
  link.lose = [&](const wire::CanFrame& f) { return wire::decode_full(f) && ++turn % 5 == 0; };
  stream.run_until(bus.now_us() + 1'000'000);
  link.lose = {};
  stream.finish();
  const session::StreamReport r = stream.report();
  EXPECT_EQ(r.lost_host, link.thrown_away());
  EXPECT_EQ(r.lost_bus, 0U);
}

TEST(Loss, a_module_that_gives_no_data_was_never_heard) {
  hardware::Scene scene = strip_scene(6, 6);
  hardware::Fault f;
  f.kind = hardware::FaultKind::kRemovedChip;
  f.module = layout::ModuleId{4};
  scene.faults.push_back(f);
  SharedSkin hub(std::move(scene));
  hub.flash();
  SharedSkin::Client link(hub);
  session::Bus bus(link);
  bus.listen(bus.now_us() + 500'000);
  session::Stream stream(bus, hub.design(), {});
  stream.run_until(bus.now_us() + 1'000'000);
  stream.finish();
  const session::StreamReport r = stream.report();
  EXPECT_EQ(r.never_heard, std::vector{design::ModuleNumber{4}});
  EXPECT_FALSE(r.complete());
  EXPECT_EQ(r.total.lost(), 0U);  // The controller reported each time that there was nothing.
}

// A controller that loses power resumes streaming by itself: the lease is renewed, and the samples that it did not take
// are counted by the rate.
TEST(Loss, a_controller_that_was_away_is_noticed_in_half_a_second_and_counted) {
  SharedSkin hub(strip_scene(6, 3));
  hub.flash();
  SharedSkin::Client link(hub);
  session::Bus bus(link);
  std::vector<std::pair<std::uint64_t, std::string>> said;
  session::StreamOptions options;
  options.say = [&](const std::string& text) { said.emplace_back(bus.now_us(), text); };
  session::Stream stream(bus, hub.design(), {}, options);
  stream.run_until(bus.now_us() + 1'000'000);
  link.lose = [](const wire::CanFrame& f) {  // Its cable is pulled.
    const auto t = wire::decode_full(f);
    return t.has_value() && t->node_address == 2;
  };
  const std::uint64_t pulled_us = bus.now_us();
  stream.run_until(bus.now_us() + 1'500'000);
  ASSERT_EQ(said.size(), 1U);
  EXPECT_LE(said[0].first - pulled_us, 500'000U);
  EXPECT_NE(said[0].second.find("patch 1"), std::string::npos) << said[0].second;
  hub.skin().power_cycle(1);
  link.lose = {};
  stream.run_until(bus.now_us() + 2'000'000);
  stream.finish();
  EXPECT_EQ(said.size(), 2U);
  const session::StreamReport r = stream.report();
  std::map<int, session::SampleCounts> patch;
  for (const session::ModuleCounts& m : r.modules) patch[m.patch] += m.counts;
  EXPECT_EQ(patch[0].lost(), 0U);
  SCOPED_TRACE(session::sentences(r).at(0));
  const double due = 3 * 4.5e6 / kSequence_us;
  EXPECT_NEAR(static_cast<double>(patch[1].expected), due, 0.05 * due);
  EXPECT_NEAR(static_cast<double>(patch[1].lost()), 3 * 1.5e6 / kSequence_us, 0.1 * due);
}

// Three of four cables are pulled. Five attempts each would take 15 times the wait for an answer at the end.
TEST(Loss, silent_controllers_are_asked_once_at_the_end) {
  SharedSkin hub(strip_scene(8, 2));
  hub.flash();
  SharedSkin::Client link(hub);
  session::Bus bus(link);
  session::Stream stream(bus, hub.design(), {}, {});
  stream.run_until(bus.now_us() + 500'000);
  link.lose = [](const wire::CanFrame& f) {
    const auto t = wire::decode_full(f);
    const bool is_answer = f.extended && (f.id & 0x1FFFFF00U) == wire::physical_id(wire::kTesterAddress, 0);
    return (t.has_value() && t->node_address > 1) || (is_answer && (f.id & 0xFF) > 1);
  };
  stream.run_until(bus.now_us() + 1'500'000);
  const std::uint64_t before_us = bus.now_us();
  stream.finish();
  EXPECT_LT(bus.now_us() - before_us, 2 * 3 * link.answer_us());
  std::map<int, session::SampleCounts> patch;
  for (const session::ModuleCounts& m : stream.report().modules) patch[m.patch] += m.counts;
  EXPECT_EQ(patch[0].lost(), 0U) << "the one that answers owes nothing";
  for (const int p : {1, 2, 3}) EXPECT_GT(patch[p].lost(), 0U) << p;
}

}  // namespace
}  // namespace triskin::deploy
