// SPDX-License-Identifier: GPL-3.0-or-later
#include "triskin/board/i2c_timing.hpp"

#include <gtest/gtest.h>

namespace triskin::board {
namespace {

// By hand for 160 MHz (6.25 ns). Data set-up needs 400 ns in at most 16 units, so a unit is at least 25 ns: prescaler
// 3, 16 units. The synchronization of both edges is 2 · (50 + 2 · 6.25) = 125 ns; 2375 ns remain: 95 units of low and
// high. Low needs 52 (1300 ns), high 24 (600 ns); high gets a third of the spare 19, which is 6. The longest fall of
// fast mode, 300 ns, less the part that the filter and three clocks hide, 68.75 ns: 231.25 ns are 10 units of data
// hold. Data are valid after 250 + 260 + 25 + 300 = 835 ns, within 900.
TEST(I2cTiming, WorkedByHandAt160MHz) {
  const auto t = compute_i2c_timing({});
  ASSERT_TRUE(t.has_value());
  EXPECT_EQ(t->prescaler, 3);
  EXPECT_EQ(t->low + 1, 65);
  EXPECT_EQ(t->high + 1, 30);
  EXPECT_EQ(t->data_setup + 1, 16);
  EXPECT_EQ(t->data_delay, 10);
  EXPECT_EQ(t->period_ns, 2500U);
  EXPECT_EQ(t->value(), 3U << 28 | 15U << 20 | 10U << 16 | 29U << 8 | 64U);
}

// Holding the data for the longest fall costs no speed.
TEST(I2cTiming, FallsOfFastModeHaveTheSamePeriod) {
  for (const std::uint32_t fall_ns : {20U, 100U, 300U})
    EXPECT_EQ(compute_i2c_timing({kSysclk_hz, 400'000, 300, fall_ns})->period_ns, 2500U) << fall_ns;
}

TEST(I2cTiming, KeepsTheLimitsOfFastModeForEveryClock) {
  for (std::uint32_t hz = 8'000'000; hz <= 170'000'000; hz += 1'000'000) {
    for (const std::uint32_t bus : {100'000U, 250'000U, 400'000U}) {
      const auto t = compute_i2c_timing({hz, bus, 300, 20});
      if (!t) continue;
      EXPECT_GE(t->low_ns, 1300U) << hz;
      EXPECT_GE(t->high_ns, 600U) << hz;
      EXPECT_GE(t->period_ns + 1, 1'000'000'000U / bus) << hz;
      EXPECT_LE(t->data_setup, 15);
      EXPECT_LE(t->data_delay, 15);
    }
  }
}

TEST(I2cTiming, RefusesWhatFastModeDoesNotHave) {
  EXPECT_EQ(compute_i2c_timing({160'000'000, 0, 300, 20}).error(), Status::kOutOfRange);
  EXPECT_EQ(compute_i2c_timing({160'000'000, 1'000'000, 300, 20}).error(), Status::kOutOfRange);
  EXPECT_EQ(compute_i2c_timing({4'000'000, 400'000, 300, 20}).error(), Status::kOutOfRange);
  // The data would be late.
  EXPECT_EQ(compute_i2c_timing({160'000'000, 400'000, 900, 20}).error(), Status::kOutOfRange);
}

}  // namespace
}  // namespace triskin::board
