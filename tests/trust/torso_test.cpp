// SPDX-License-Identifier: GPL-3.0-or-later
// Runs the two largest covers of the robot, by their numbers of modules, on one FD bus for a minute: samples that fit
// must arrive, and the others must be counted, module by module, as the simulated hardware had them.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cstdio>
#include <iterator>

#include "shared_skin.hpp"
#include "triskin/session/stream.hpp"
#include "triskin/wire/bus_load.hpp"

namespace triskin::test {
namespace {

using test::kSequence_us;
using test::SampleName;
using test::SharedSkin;
using test::strip_scene;

constexpr double kSeconds = 60.0;

// `nominal` and `data` are in bit/s and must divide a clock of 80 MHz; `every` is n. `load` is that of each n-th
// sample, with the longest frames; 1 is the share of samples.
struct Case {
  const char* name;
  int modules, controllers;
  std::uint64_t nominal, data;
  int every;
  double load;
};
void PrintTo(const Case& c, std::ostream* out) {
  *out << c.name;
}

class LargeCover : public testing::TestWithParam<Case> {};

TEST_P(LargeCover, every_sample_of_a_minute_arrives_or_is_counted) {
  const Case& c = GetParam();
  hardware::Scene scene = strip_scene(c.modules, 16, c.nominal, c.data);
  scene.effects.converters.drawn = false;  // What is due is counted in sequences of nominal length.
  SharedSkin hub(std::move(scene));
  ASSERT_EQ(hub.design().patches.size(), static_cast<std::size_t>(c.controllers));
  hub.flash();
  SharedSkin::Client link(hub);
  session::Bus bus(link);
  bus.listen(bus.now_us() + 2'000'000);  // The offsets are found by now.
  const double share = wire::kStreamShare * kSequence_us * 1e3 / static_cast<double>(link.sample_ns(1));
  EXPECT_NEAR(c.modules / (share * c.every), c.load, 0.05 * c.load) << "the case is not what its name says";

  std::map<std::pair<int, int>, std::set<std::uint32_t>> came;  // The key is node address and row.
  session::StreamOptions options;
  options.every = c.every;
  options.overload = true;
  hub.forget();
  session::Stream stream(
      bus, hub.design(),
      [&](const session::ModuleSample& f) { came[{f.sample.node_address, f.sample.module}].insert(f.sample.sample); },
      options);
  stream.run_until(bus.now_us() + static_cast<std::uint64_t>(kSeconds * 1e6));
  stream.finish();
  const session::StreamReport r = stream.report();

  // The scene gives the truth: which samples left the bus, and how many conversions there were in the time.
  std::map<std::pair<int, int>, std::set<std::uint32_t>> truth;
  for (const SampleName& s : hub.on_bus()) truth[{s.node, s.row}].insert(s.number);
  std::uint64_t left = 0;
  for (const auto& [module, numbers] : came) {
    for (const std::uint32_t n : numbers) EXPECT_TRUE(truth[module].contains(n));
    // Samples before the lease and after its end do not belong to this reader: at most one on each side.
    const auto& all = truth[module];
    EXPECT_LE(std::distance(all.lower_bound(*numbers.begin()), all.upper_bound(*numbers.rbegin())),
              static_cast<std::ptrdiff_t>(numbers.size()));
    left += numbers.size();
  }
  ASSERT_EQ(r.modules.size(), static_cast<std::size_t>(c.modules));
  session::SampleCounts sum;
  std::uint64_t least = UINT64_MAX, most = 0;
  const double due = kSeconds * 1e6 / kSequence_us / c.every;
  for (const session::ModuleCounts& m : r.modules) {
    EXPECT_EQ(m.counts.expected, m.counts.received + m.counts.unread + m.counts.dropped) << m.module;
    EXPECT_NEAR(static_cast<double>(m.counts.expected), due, 2.0 + 0.01 * due) << m.module;
    sum += m.counts;
    least = std::min(least, m.counts.received);
    most = std::max(most, m.counts.received);
  }
  EXPECT_EQ(sum, r.total);
  EXPECT_EQ(r.total.received, left);
  EXPECT_TRUE(r.never_heard.empty());
  EXPECT_GE(static_cast<double>(least), 0.95 * static_cast<double>(most)) << least << " … " << most;
  if (c.load <= 1.0) {
    EXPECT_TRUE(r.complete()) << session::sentences(r).at(0);
    EXPECT_EQ(r.total.lost(), 0U);
  } else {
    EXPECT_FALSE(r.complete());
    EXPECT_EQ(r.starved.size(), hub.design().patches.size());
  }
  std::fputs(fmt::format("{}: {} due, {} received, {} dropped, {} unread\n", c.name, r.total.expected, r.total.received,
                         r.total.dropped, r.total.unread)
                 .c_str(),
             stdout);
}

INSTANTIATE_TEST_SUITE_P(Covers, LargeCover,
                         testing::Values(Case{"torso_fits", 151, 10, 1'000'000, 4'000'000, 1, 0.85},
                                         Case{"torso_10_percent_too_much", 151, 10, 500'000, 4'000'000, 1, 1.1},
                                         Case{"torso_100_percent_too_much", 151, 10, 1'000'000, 1'356'000, 1, 2.0},
                                         Case{"lower_torso_fits", 207, 13, 1'000'000, 2'000'000, 2, 0.99},
                                         Case{"lower_torso_10_percent_too_much", 207, 13, 1'000'000, 4'444'000, 1, 1.1},
                                         Case{"lower_torso_100_percent_too_much", 207, 13, 1'000'000, 2'000'000, 1,
                                              2.0}),
                         [](const auto& tested) { return std::string(tested.param.name); });

}  // namespace
}  // namespace triskin::test
