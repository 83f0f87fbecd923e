// SPDX-License-Identifier: GPL-3.0-or-later
// Tests a simulated skin as every reader sees it: samples in one form, rest values, tare, losses, a link that returns.
#include "triskin/skin/live_skin.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cstdlib>
#include <filesystem>
#include <map>
#include <thread>

#include "support/strip_design.hpp"
#include "triskin/deploy/flash.hpp"
#include "triskin/hardware/sim_server.hpp"
#include "triskin/skin/sample_queue.hpp"

namespace triskin::skin {
namespace {

constexpr int kModules = 8, kPressed = 5, kTaxel = 3;

// Provides a design of eight modules on two simulated controllers that hold its tables; stored files go to a folder of
// the test.
class LiveSkins : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = std::filesystem::temp_directory_path() / ("live_skin." + std::to_string(::getpid()));
    std::filesystem::remove_all(folder_);
    std::filesystem::create_directories(folder_);
    ::setenv("XDG_STATE_HOME", folder_.c_str(), 1);
    design::write_design(file(), test::strip(kModules, 4));
    const auto link = connect::open_link(simulated(), &site_of_design().buses[0].covers[0].design);
    session::Bus bus(*link);
    (void)deploy::flash(bus, test::strip(kModules, 4));
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }

  [[nodiscard]] std::string file() const { return folder_ / "strip.json"; }
  [[nodiscard]] robot::Site site_of_design() const { return robot::read_site(file()); }
  static connect::LinkOptions simulated() {
    return {.link = "sim", .chosen = true, .scene = "", .own_interrupts = false};
  }
  [[nodiscard]] LiveSkin opened() const {
    LiveSkin skin(site_of_design(), simulated());
    skin.open();
    return skin;
  }
  static void pass(LiveBus& bus, std::uint64_t us) { bus.run({.until_us = bus.now_us() + us}); }

  std::filesystem::path folder_;
};

TEST_F(LiveSkins, give_samples_of_every_module_with_their_time) {
  const LiveSkin skin = opened();
  LiveBus& bus = *skin.buses().front();
  std::map<int, int> heard;
  std::uint64_t newest_ns = 0;
  bus.start({}, [&](const LiveSample& s) {
    ++heard[s.module];
    newest_ns = std::max(newest_ns, s.unix_ns);
    EXPECT_EQ(s.cover, 0);
    EXPECT_EQ(s.valid, s.raw.sample.valid);
    EXPECT_FALSE(s.pressure_kpa.has_value());  // Nobody has calibrated the skin.
  });
  pass(bus, 1'000'000);
  EXPECT_EQ(heard.size(), static_cast<std::size_t>(kModules));
  // The newest sample is no older than a sequence and its transfer over the bus.
  EXPECT_LT(bus.unix_ns(bus.now_us()) - newest_ns, 100'000'000U);
  bus.finish();
  EXPECT_EQ(bus.report().total.lost(), 0U);
  EXPECT_EQ(bus.report(0).total.received, bus.report().total.received);
  EXPECT_EQ(bus.totals().frames, bus.report().total.received);
  // A second stream is counted together with the first.
  const std::uint64_t before = bus.totals().frames;
  bus.start({}, {});
  pass(bus, 500'000);
  EXPECT_GT(bus.totals().frames, before);
  EXPECT_LT(bus.report().total.received, bus.totals().frames);
}

TEST_F(LiveSkins, show_which_taxel_is_pressed_and_forget_it_by_a_tare) {
  const LiveSkin skin = opened();
  LiveBus& bus = *skin.buses().front();
  std::map<int, LiveSample> last;
  bus.start({}, [&](const LiveSample& s) { last.insert_or_assign(s.module, s); });
  LiveCover& cover = bus.covers().front();
  pass(bus, 500'000);
  cover.actuator()->press({layout::ModuleId{kPressed}, layout::TaxelIndex{kTaxel}});
  pass(bus, 500'000);
  for (const auto& [module, s] : last) {
    for (int t = 0; t < int{layout::kTaxelsPerModule}; ++t) {
      const bool pressed = s.change_counts[static_cast<std::size_t>(t)] > TouchMap::kPressed_counts;
      const bool is_far = std::abs(module - kPressed) > 1;
      EXPECT_FALSE(pressed && is_far) << module << ' ' << t;
      EXPECT_TRUE(pressed || module != kPressed || t != kTaxel);
    }
  }
  EXPECT_EQ(cover.touches().pressed().at(0).module, kPressed);
  bus.tare();
  EXPECT_EQ(cover.tare().state(), Tare::State::kDone);
  EXPECT_TRUE(cover.touches().pressed().empty());
}

TEST_F(LiveSkins, begin_with_rest_values_that_were_kept) {
  design::RestValues kept;
  {
    const LiveSkin skin = opened();
    LiveBus& bus = *skin.buses().front();
    bus.start({}, {});
    EXPECT_TRUE(bus.covers().front().kept_rest().empty());
    bus.tare();
    kept = bus.covers().front().touches().rest();
    EXPECT_TRUE(std::filesystem::exists(bus.covers().front().keep_rest()));
  }
  const LiveSkin skin = opened();
  LiveBus& bus = *skin.buses().front();
  bus.find_controllers();
  EXPECT_EQ(bus.claims().size(), 2U);
  EXPECT_EQ(bus.covers().front().kept_rest(), kept);
  bus.find_controllers(RestSource::kNone);
  EXPECT_TRUE(bus.covers().front().kept_rest().empty());
}

TEST_F(LiveSkins, give_kpa_by_a_calibration) {
  const LiveSkin skin = opened();
  LiveBus& bus = *skin.buses().front();
  LiveCover& cover = bus.covers().front();
  const auto steps = pressure_steps(std::array{10.0, 20.0, 40.0}, {});
  CalibrateOptions options;
  options.settle_s = 0.2;
  options.hold_s = 0.3;
  options.apply = [&](const PressureStep& step) {
    cover.actuator()->pressurize(layout::ModuleId::none(), step.pressure_kpa);
  };
  bus.find_controllers();
  const CalibrationOutcome outcome = calibrate_by_steps(bus.bus(), cover.design(), steps, options);
  ASSERT_TRUE(outcome.without.empty());
  cover.actuator()->pressurize(layout::ModuleId::none(), 0.0);
  cover.set_calibration(bus.find_calibration(cover, outcome.boards).skin);
  ASSERT_TRUE(cover.calibration().complete());
  std::map<int, double> kpa;
  bus.start({}, [&](const LiveSample& s) { kpa[s.module] = s.pressure_kpa.value()[kTaxel]; });
  pass(bus, 500'000);
  cover.actuator()->pressurize(layout::ModuleId::none(), 30.0);
  pass(bus, 500'000);
  // The line of the calibration bends by less than the error that docs/calibration.md allows, 10 %.
  for (const auto& [module, pressure_kpa] : kpa) EXPECT_NEAR(pressure_kpa, 30.0, 3.0) << module;
}

TEST_F(LiveSkins, open_a_link_again_that_was_cut) {
  hardware::Scene scene;
  scene.design = test::strip(kModules, 4);
  hardware::VirtualSkin hardware(std::move(scene), folder_ / "served");
  auto server = std::make_unique<hardware::SimServer>(hardware, hardware::HostPort{"127.0.0.1", 0});
  connect::LinkOptions link = simulated();
  link.link = server->link_name();
  const hardware::HostPort at{"127.0.0.1", server->port()};
  server.reset();  // Nobody listens there now.
  std::atomic<bool> stop = false;
  std::jthread serving;
  int cuts = 0;
  LiveSkin skin(site_of_design(), link);
  LiveBus& bus = *skin.buses().front();
  LiveRun run;
  run.after_slice = [&] { return bus.totals().frames < 50; };
  bus.follow({}, {}, run, [&](const std::string& trouble) {
    EXPECT_FALSE(trouble.empty());
    if (++cuts > 1) return;
    server = std::make_unique<hardware::SimServer>(hardware, at);
    serving = std::jthread([&] { server->run(stop, 0.0); });
    const auto wire = connect::open_link(link, nullptr);
    session::Bus flashing(*wire);
    (void)deploy::flash(flashing, test::strip(kModules, 4));
  });
  stop = true;
  EXPECT_GE(cuts, 1);
  EXPECT_GE(bus.totals().frames, 50U);
}

TEST_F(LiveSkins, wait_in_a_queue_and_are_dropped_when_nobody_reads_them) {
  LiveSkin skin = opened();
  SampleQueue queue(skin, {layout::SkinModule{100}}, 100 + kModules, 0.5, true);
  queue.start({});
  const auto samples = queue.read(1.0, 5);
  ASSERT_FALSE(samples.empty());
  EXPECT_LE(samples.size(), 5U);
  EXPECT_GE(samples[0].module, 100);  // Module numbers count over all covers.
  queue.tare();
  EXPECT_DOUBLE_EQ(queue.change_counts(layout::SkinModule{0})[0], 0.0);  // No cover has this module.
  EXPECT_EQ(queue.dropped(), 0U);
  // A tare takes at least 0.1 s, and five of them are longer than samples wait.
  for (int k = 0; k < 6; ++k) queue.tare();
  EXPECT_GT(queue.dropped(), 0U);
  queue.stop();
  EXPECT_FALSE(queue.runs());
  EXPECT_EQ(queue.counts().lost(), 0U);
}

}  // namespace
}  // namespace triskin::skin
