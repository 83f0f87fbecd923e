// SPDX-License-Identifier: GPL-3.0-or-later
// Connects switched modules to the unmodified image: the chain at SPI2, EN and latch at pins, converters as the
// registers place them.
#include <bit>

#include "bench.hpp"
#include "support/random_design.hpp"
#include "triskin/design/joint.hpp"
#include "triskin/hardware/skin.hpp"
#include "triskin/session/patch_table.hpp"
#include "triskin/wire/topology.hpp"

namespace triskin::machine {
namespace {

// A module that was not read for longer than Presence::kRecent_us is set up from nothing, as after power-up: the path
// to it is searched, then offsets and both inputs are tested over some sequences of 36.9 ms.
constexpr std::uint64_t kSetUp_us = 600'000;
// The head has sample and time; each module has validity and twelve values.
constexpr std::size_t kLiveHead = 12, kLiveModule = 26;

class SwitchedBench : public Bench {
 protected:
  /// Powers a controller whose flash holds the table of the design, on the switched modules of the design.
  void power_up_on(const design::Design& design) {
    scene_.design = design;
    scene_.switched = true;
    scene_.effects.taxel_spread_counts = 3000;
    hardware_ = std::make_unique<hardware::SwitchedHardware>(scene_);
    skin_ = std::make_unique<hardware::Skin>(scene_, hardware_.get());
    layout::PatchImage table = session::image_of(design, layout::PatchIndex{0});
    table.node_address = 1;
    store_table(table);
    MachineSetup setup;
    for (int l = 0; l < layout::kLines; ++l)
      setup.lines[static_cast<std::size_t>(l)] = &skin_->line(layout::PatchIndex{0}, l);
    setup.flash = &flash;
    setup.on_can = [this](const wire::CanFrame& f, std::uint64_t) { frames.push_back(f); };
    setup.chain = &chain();
    machine = std::make_unique<Machine>(setup);
    run_for(kSetUp_us);
  }
  [[nodiscard]] hardware::SwitchedPatch& chain() { return hardware_->patch(layout::PatchIndex{0}); }
  [[nodiscard]] wire::ActiveRoute route() { return wire::ActiveRoute::decode(answer(wire::did::kRoute)).value(); }
  [[nodiscard]] wire::FoundTopology topology() {
    return wire::FoundTopology::decode(answer(wire::did::kTopology)).value();
  }
  /// Returns the modules all of whose taxels are valid, one bit per row.
  [[nodiscard]] std::uint32_t read_rows() {
    const std::vector<std::uint8_t> taxels = answer(wire::did::kLiveTaxels);
    std::uint32_t valid = 0;
    for (std::size_t m = 0, at = kLiveHead; m < scene_.design.patches[0].modules.size(); ++m, at += kLiveModule) {
      if ((taxels.at(at) | taxels.at(at + 1) << 8) == layout::kAllTaxels) valid |= 1U << m;
    }
    return valid;
  }

 private:
  std::vector<std::uint8_t> answer(std::uint16_t identifier) {
    const auto r = request({0x22, static_cast<std::uint8_t>(identifier >> 8), static_cast<std::uint8_t>(identifier)});
    EXPECT_GT(r.size(), 3U);
    return r.size() > 3 ? std::vector<std::uint8_t>(r.begin() + 3, r.end()) : std::vector<std::uint8_t>(64);
  }
  hardware::Scene scene_;
  std::unique_ptr<hardware::SwitchedHardware> hardware_;
  std::unique_ptr<hardware::Skin> skin_;
};

std::uint32_t all_of(const design::Design& d) {
  return (1U << d.patches[0].modules.size()) - 1;
}

TEST_F(SwitchedBench, the_image_finds_every_joint_and_reads_every_module) {
  std::mt19937_64 random(31);
  const design::Design design = test::random_design(16, random);
  power_up_on(design);
  const wire::FoundTopology found = topology();
  EXPECT_TRUE(found.switched);
  EXPECT_TRUE(found.complete);
  ASSERT_EQ(found.count, 16);
  const design::PortEnds joints = design::joints_of(design, layout::PatchIndex{0});
  for (std::size_t n = 0; n < layout::kMaxModules; ++n) {
    const std::size_t row = found.row[n];
    ASSERT_LT(row, 16U);
    for (std::size_t p = 0; p < 3; ++p) {
      const design::PortEnd& real = joints[row][p];
      const std::uint8_t joint = found.joints[n][p];
      ASSERT_EQ(joint != 0, real.row >= 0) << "row " << row << " port " << p;
      if (joint == 0) continue;
      EXPECT_EQ(found.row[layout::joint_row(joint)], real.row) << "row " << row << " port " << p;
      EXPECT_EQ(layout::joint_port(joint), real.port) << "row " << row << " port " << p;
    }
  }
  EXPECT_EQ(route().alive, all_of(design));
  EXPECT_EQ(read_rows(), all_of(design));
  expect_no_violation();
}

// Checking the chain and keeping the route costs the core little beside reading sixteen modules, which both patches do
// at the same rate.
TEST_F(SwitchedBench, route_keeping_costs_few_cycles) {
  const auto instructions_per_second = [this] {
    constexpr std::uint64_t kRun_us = 3'000'000;
    run_for(500'000);
    const std::uint64_t before = machine->counts().instructions;
    run_for(kRun_us);
    return static_cast<double>(machine->counts().instructions - before) * 1e6 / static_cast<double>(kRun_us);
  };
  std::mt19937_64 random(31);
  const design::Design design = test::random_design(16, random);
  power_up_on(design);
  const double switched = instructions_per_second();
  EXPECT_EQ(read_rows(), all_of(design));
  store_table(patch(16));
  power_up();
  run_for(kSetUp_us);
  const double strapped = instructions_per_second();
  std::printf(
      "16 modules at 36.9 ms: %.2f million instructions a second with switched modules, %.2f with strapped ones\n",
      switched / 1e6, strapped / 1e6);
  EXPECT_GT(switched, strapped);
  EXPECT_LT(switched - strapped, 0.05 * static_cast<double>(machine->sysclk_hz())) << "a twentieth of the core";
}

TEST_F(SwitchedBench, forty_random_patches_are_found_within_50_ms) {
  std::mt19937_64 random(33);
  std::uint32_t slowest_us = 0;
  for (int trial = 0; trial < 40; ++trial) {
    const design::Design design = test::random_design(1 + trial % 16, random);
    power_up_on(design);
    EXPECT_EQ(topology().count, design.patches[0].modules.size()) << trial;
    EXPECT_EQ(read_rows(), all_of(design)) << trial;
    slowest_us = std::max(slowest_us, route().last_us);
    expect_no_violation();
  }
  EXPECT_GT(slowest_us, 1'000U);
  EXPECT_LE(slowest_us, 50'000U);
  std::printf("slowest way from power-up to a tree: %.1f ms of virtual time\n", slowest_us / 1000.0);
}

// A module may die at any moment of a cycle: samples of the others are back within 100 ms.
TEST_F(SwitchedBench, every_dead_module_is_left_out_within_100_ms) {
  std::mt19937_64 random(34);
  for (int trial = 0; trial < 3; ++trial) {
    const design::Design design = test::random_design(16, random);
    power_up_on(design);
    for (int dead = 0; dead < layout::kMaxModules; ++dead) {
      run_for(random() % 37'000);
      chain().set_dead(layout::TableRow{dead}, true);
      run_for(100'000);
      const std::uint32_t rows = read_rows();
      EXPECT_EQ(rows, test::rows_that_survive(design, {{dead}, {}})) << "trial " << trial << " module " << dead;
      chain().set_dead(layout::TableRow{dead}, false);
      EXPECT_EQ(request({0x31, 0x01, 0x02, 0x04}).at(0), 0x71);
      run_for(kSetUp_us);
      ASSERT_EQ(read_rows(), all_of(design)) << "trial " << trial << " module " << dead << " is back";
    }
    expect_no_violation();
  }
}

TEST_F(SwitchedBench, a_dead_module_is_left_out_and_comes_back_on_command) {
  std::mt19937_64 random(32);
  const design::Design design = test::random_design(12, random);
  power_up_on(design);
  ASSERT_EQ(route().alive, all_of(design));
  chain().set_dead(layout::TableRow{7}, true);
  run_for(150'000);
  const wire::ActiveRoute rerouted = route();
  EXPECT_EQ(rerouted.alive >> 7 & 1, 0U);
  EXPECT_GE(std::popcount(static_cast<unsigned>(rerouted.alive)), 6);
  run_for(60'000);
  EXPECT_EQ(read_rows(), rerouted.alive);
  chain().set_dead(layout::TableRow{7}, false);
  EXPECT_EQ(request({0x31, 0x01, 0x02, 0x04}).at(0), 0x71);
  run_for(150'000);
  EXPECT_EQ(route().alive, all_of(design));
  run_for(kSetUp_us - 150'000);
  EXPECT_EQ(read_rows(), all_of(design));
  expect_no_violation();
}

}  // namespace
}  // namespace triskin::machine
