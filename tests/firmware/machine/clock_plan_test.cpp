// SPDX-License-Identifier: GPL-3.0-or-later
#include "triskin/board/clock_plan.hpp"

#include <gtest/gtest.h>

namespace triskin::board {
namespace {

// By hand: 320 MHz from 8, 16 and 24 MHz are 40 times 8 MHz (16 MHz that are 2 % fast would exceed the PLL's input); 25
// MHz allow no such divisor but 5, 64 times 5 MHz.
TEST(ClockPlan, WorkedByHand) {
  EXPECT_EQ(pll_setting(8'000'000), (PllSetting{1, 40}));
  EXPECT_EQ(pll_setting(16'000'000), (PllSetting{2, 40}));
  EXPECT_EQ(pll_setting(24'000'000), (PllSetting{3, 40}));
  EXPECT_EQ(pll_setting(25'000'000), (PllSetting{5, 64}));
  // 13 · 2 MHz fails, because the PLL accepts no less than 2.66 MHz.
  EXPECT_EQ(pll_setting(26'000'000), std::nullopt);
  EXPECT_EQ(pll_setting(3'000'000), std::nullopt);
}

TEST(ClockPlan, EachSettingKeepsTheLimitsOfThePll) {
  for (std::uint32_t mhz = 1; mhz <= 48; ++mhz) {
    const auto s = pll_setting(mhz * 1'000'000);
    if (!s) continue;
    const double input = mhz * 1e6 / s->divider;
    EXPECT_GE(input, 2.66e6) << mhz;
    EXPECT_LE(1.02 * input, 16e6) << mhz << ", the internal oscillator may be 2 % fast";
    EXPECT_DOUBLE_EQ(input * s->factor, 320e6) << mhz;
  }
}

TEST(ClockPlan, MeasurementMeansTheCrystalWithinTwoPercent) {
  // At the edge of the oscillator's error, 24 and 25 MHz are still told apart.
  EXPECT_EQ(crystal_near(24'480'000), 24'000'000U);
  EXPECT_EQ(crystal_near(24'500'000), 25'000'000U);
  EXPECT_EQ(crystal_near(24'490'000), std::nullopt);
  EXPECT_EQ(crystal_near(18'432'000), std::nullopt);
  EXPECT_EQ(crystal_near(7'850'000), 8'000'000U);
  EXPECT_EQ(crystal_near(0), std::nullopt);
}

}  // namespace
}  // namespace triskin::board
