// SPDX-License-Identifier: GPL-3.0-or-later
// For each failure of a module or a line, the bus must show the right message of the controller, and the others must
// continue.
#include <gtest/gtest.h>

#include "bench.hpp"
#include "triskin/logic/sampling/duplicate_check.hpp"

namespace triskin::test {
namespace {

using wire::ModuleState;

struct Faults : testing::Test {
  Bench bench;
  ChipDouble& chip(int k) {
    return bench.lines[static_cast<std::size_t>(k / 2)].chips.at(static_cast<std::size_t>(k % 2));
  }

  void start() {
    bench.power_up();
    ASSERT_EQ(bench.flash_table(six_modules()), Status::kOk);
    bench.run(1'000'000);
  }
  void SetUp() override { place_six(bench); }

  void expect_all_ok_but(std::vector<int> bad, ModuleState state) {
    for (int k = 0; k < 6; ++k) {
      const bool is_bad = std::ranges::find(bad, k) != bad.end();
      EXPECT_EQ(bench.state(static_cast<std::size_t>(k)), is_bad ? state : ModuleState::kOk) << "module " << k;
    }
  }
  std::uint32_t statistic(std::size_t index) {
    const Message m = bench.ask({0x22, 0xFD, 0x04});
    return ByteReader(Bytes(m).subspan(3 + 4 * index)).le32();
  }
};

TEST_F(Faults, NoneOnAHealthySkin) {
  start();
  expect_all_ok_but({}, ModuleState::kOk);
  EXPECT_EQ(statistic(1), 0U);  // Bus errors are counted here.
  // Three find the offsets, four tell one chip from two, one has shifted offsets.
  EXPECT_EQ(chip(0).configurations, 8);
  const Message dtcs = bench.ask({0x19, 0x02, 0xFF});
  EXPECT_EQ(dtcs, (Message{0x59, 0x02, 0x09}));  // No fault was seen in the meantime.
}

TEST_F(Faults, FirstReadingsAreReal) {
  start();
  const Message live = bench.ask({0x22, 0xFD, 0x10});
  ASSERT_EQ(live.size(), 3U + 12 + 6 * 26);
  ByteReader r(Bytes(live).subspan(3 + 12));
  for (int k = 0; k < 6; ++k) {
    EXPECT_EQ(r.le16(), 0x0FFF) << k;
    for (int t = 0; t < 12; ++t) {
      const double counts = r.le16() - 0x8000, steps = (counts + 8000 + 97 * k + 31 * t) / (0.32 * 4096);
      EXPECT_LE(std::abs(counts), 0.32 * 4096);  // An offset cancels the electrode.
      EXPECT_NEAR(steps, std::round(steps), 4 / (0.32 * 4096));
    }
  }
}

// The chip's own compensation is off in every stage (STAGE_CAL_EN), and its status has every stage (0x007).
TEST_F(Faults, NoStageIsCalibratedByTheChip) {
  start();
  for (int k = 0; k < 6; ++k) {
    EXPECT_EQ(chip(k).read(0x001, bench.now_us), 0) << k;
    EXPECT_EQ(chip(k).read(0x007, bench.now_us), 0x0FFF) << k;
  }
}

TEST_F(Faults, AbsentModule) {
  chip(3).powered = false;
  start();
  expect_all_ok_but({3}, ModuleState::kAbsent);
  chip(3).powered = true;  // The chip is plugged in again.
  bench.run(1'000'000);
  expect_all_ok_but({}, ModuleState::kOk);
  // The fault has come and gone.
  EXPECT_EQ(bench.ask({0x19, 0x02, 0x08}), (Message{0x59, 0x02, 0x09, 0x92, 0, 3, 0x08}));
  EXPECT_EQ(bench.ask({0x19, 0x04, 0x92, 0, 3, 0xFF}).at(0), 0x59);
}

TEST_F(Faults, ModuleAtAnotherAddressIsFoundByDiscovery) {
  chip(2).address = 0x2F;
  start();
  expect_all_ok_but({2}, ModuleState::kAbsent);
  ASSERT_EQ(bench.ask({0x31, 0x01, 0x02, 0x01}), (Message{0x71, 0x01, 0x02, 0x01}));
  bench.run(100'000);
  EXPECT_EQ(bench.ask({0x31, 0x03, 0x02, 0x01}),
            (Message{0x71, 0x03, 0x02, 0x01, 1, 0, 0b0011, 0, 0, 0b1010, 0, 0, 0b0011, 0, 0, 0, 0}));
}

TEST_F(Faults, DiscoveryWorksWithoutATable) {
  bench.power_up();
  chip(5).device_id = 0x1234;
  ASSERT_EQ(bench.ask({0x31, 0x01, 0x02, 0x01}).at(0), 0x71);
  bench.run(100'000);
  EXPECT_EQ(bench.ask({0x31, 0x03, 0x02, 0x01}),
            (Message{0x71, 0x03, 0x02, 0x01, 1, 0, 3, 0, 0, 3, 0, 0, 3, 2, 0, 0, 0}));
}

TEST_F(Faults, WrongDeviceId) {
  chip(4).device_id = 0x1490;
  start();
  expect_all_ok_but({4}, ModuleState::kWrongId);
}

TEST_F(Faults, TwoModulesAtOneAddress) {
  chip(1).address = 0x2C;
  start();
  EXPECT_EQ(bench.state(0), ModuleState::kDuplicate);
  EXPECT_EQ(bench.state(1), ModuleState::kAbsent);
  EXPECT_EQ(bench.state(2), ModuleState::kOk);
  chip(1).address = 0x2D;  // The chip has the right straps now.
  bench.run(3'000'000);
  expect_all_ok_but({}, ModuleState::kOk);
}

// A strap breaks: the chip answers at the address of another one, with its own configuration. Or it is plugged in
// there, without one. The first chip never lost its own.
TEST_F(Faults, ASecondChipThatJoinsLaterIsFound) {
  start();
  for (const bool configured : {true, false}) {
    SCOPED_TRACE(configured);
    expect_all_ok_but({}, ModuleState::kOk);
    if (!configured) chip(1).dip();
    chip(1).address = 0x2C;
    bench.run(3'000'000);
    EXPECT_EQ(bench.state(0), ModuleState::kDuplicate);
    EXPECT_EQ(bench.state(1), ModuleState::kAbsent);
    for (std::size_t other = 2; other < 6; ++other) EXPECT_EQ(bench.state(other), ModuleState::kOk) << other;
    chip(1).address = 0x2D;
    bench.run(3'000'000);
  }
  expect_all_ok_but({}, ModuleState::kOk);
}

// An unconfigured chip shows no end of a sequence: without a look at its configuration it would be waited for.
TEST(JoiningChip, ADipDuringTheSetupEndsInData) {
  for (std::uint64_t dips_us = 0; dips_us < 1'000'000; dips_us += 9'000) {
    Bench bench;
    place_six(bench);
    bench.power_up();
    ASSERT_EQ(bench.flash_table(six_modules()), Status::kOk);
    bench.run(dips_us);
    bench.lines[0].chips.at(0).dip();
    bench.run(2'000'000);
    EXPECT_EQ(bench.state(0), ModuleState::kOk) << dips_us;
  }
}

// At every moment of the first second, in which the first chip is configured some ten times and the second one with it.
TEST(JoiningChip, IsFoundWheneverItJoins) {
  for (std::uint64_t joins_us = 0; joins_us < 1'000'000; joins_us += 9'000) {
    Bench bench;
    place_six(bench);
    bench.power_up();
    ChipDouble& second = bench.lines[0].chips.at(1);
    second.powered = false;
    second.address = 0x2C;
    ASSERT_EQ(bench.flash_table(six_modules()), Status::kOk);
    bench.run(joins_us);
    second.dip();
    second.powered = true;
    bench.run(3'000'000);
    EXPECT_EQ(bench.state(0), ModuleState::kDuplicate) << joins_us;
  }
}

TEST_F(Faults, AFingerDuringTheCheckIsNoSecondChip) {
  bench.power_up();
  ASSERT_EQ(bench.flash_table(six_modules()), Status::kOk);
  for (int k = 0; k < 20; ++k) {  // Presses and releases all taxels while the controller finds its chips.
    for (int m = 0; m < 6; ++m) {
      for (int& c : chip(m).counts) c += k % 2 == 0 ? 500 : -500;
    }
    bench.run(61'000);
    for (int m = 0; m < 6; ++m) EXPECT_NE(bench.state(static_cast<std::size_t>(m)), ModuleState::kDuplicate);
  }
}

TEST_F(Faults, SaturatedTaxel) {
  chip(0).counts[11] = 140'000;  // No offset reaches 34 pF.
  start();
  expect_all_ok_but({0}, ModuleState::kSaturated);
  const Message live = bench.ask({0x22, 0xFD, 0x10});
  EXPECT_EQ(ByteReader(Bytes(live).subspan(15)).le16(), 0x07FF);
}

TEST_F(Faults, FrozenTaxel) {
  start();
  chip(2).frozen = 1U << 4;
  bench.run(3'000'000);
  expect_all_ok_but({2}, ModuleState::kFrozen);
  const Message live = bench.ask({0x22, 0xFD, 0x10});
  EXPECT_EQ(ByteReader(Bytes(live).subspan(15 + 2 * 26)).le16(), 0x0FEF);
  chip(2).frozen = 0;
  bench.run(1'000'000);
  expect_all_ok_but({}, ModuleState::kOk);
}

TEST_F(Faults, ASkinWithoutNoiseIsNotCalledFrozen) {
  for (int k = 0; k < 6; ++k) chip(k).noise = 0;
  start();
  bench.run(5'000'000);
  expect_all_ok_but({}, ModuleState::kOk);
}

// It is written with the mark, then for both inputs with the offsets of either comparison (a second chip may have
// joined it), and at last with its own offsets.
TEST_F(Faults, LostConfigurationIsWrittenAgain) {
  constexpr int kConfigurations = 1 + 2 * fw::DuplicateCheck::kComparisons + 1;
  start();
  const int before = chip(5).configurations;
  chip(5).dip();
  bench.run(50'000);
  // The state must not be "saturated", although its zeros look like that.
  expect_all_ok_but({5}, ModuleState::kLostConfiguration);
  bench.run(400'000);
  expect_all_ok_but({}, ModuleState::kOk);
  EXPECT_EQ(chip(5).configurations, before + kConfigurations);
  EXPECT_EQ(bench.ask({0x19, 0x02, 0x08}), (Message{0x59, 0x02, 0x09, 0x94, 0, 5, 0x08}));
}

TEST_F(Faults, StuckDataIsClockedFree) {
  start();
  bench.lines[1].frees_after_pulses = 4;
  bench.lines[1].sda_low = true;
  bench.run(1'000'000);
  EXPECT_EQ(bench.lines[1].pulses, 4);
  expect_all_ok_but({}, ModuleState::kOk);
  EXPECT_EQ(statistic(2), 1U);  // Recoveries are counted here.
}

TEST_F(Faults, AShortedLineIsLeftAloneAndTheOthersKeepTheirRate) {
  start();
  bench.lines[1].scl_low = true;
  const std::uint32_t before = statistic(0);
  const int starts = bench.lines[1].starts;
  bench.run(3'690'000);
  expect_all_ok_but({2, 3}, ModuleState::kLineStuck);
  EXPECT_NEAR(static_cast<double>(statistic(0) - before), 100.0, 6.0);
  EXPECT_LE(bench.lines[1].starts - starts, 20);
  const Message lines = bench.ask({0x22, 0xFD, 0x06});
  EXPECT_EQ(lines.at(3), 0);
  EXPECT_EQ(lines.at(3 + 5), 1);
  bench.lines[1].scl_low = false;
  bench.run(2'000'000);
  expect_all_ok_but({}, ModuleState::kOk);
  EXPECT_EQ(bench.ask({0x22, 0xFD, 0x06}).at(3 + 5), 0);
}

TEST_F(Faults, DiscoveryNamesAStuckLine) {
  start();
  bench.lines[3].sda_low = true;
  bench.ask({0x31, 0x01, 0x02, 0x01});
  bench.run(1'500'000);
  EXPECT_EQ(bench.ask({0x31, 0x03, 0x02, 0x01}),
            (Message{0x71, 0x03, 0x02, 0x01, 1, 0, 3, 0, 0, 3, 0, 0, 3, 0, 1, 0, 0}));
}

TEST_F(Faults, SelfTestFindsEveryChipAnew) {
  start();
  chip(1).powered = false;
  ASSERT_EQ(bench.ask({0x31, 0x01, 0x02, 0x02}), (Message{0x71, 0x01, 0x02, 0x02}));
  EXPECT_EQ(bench.ask({0x31, 0x03, 0x02, 0x02}).at(4), 0);
  bench.run(500'000);
  EXPECT_EQ(bench.ask({0x31, 0x03, 0x02, 0x02}), (Message{0x71, 0x03, 0x02, 0x02, 1, 1, 2, 1, 1, 1, 1}));
}

}  // namespace
}  // namespace triskin::test
