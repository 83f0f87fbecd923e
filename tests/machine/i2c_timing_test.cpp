// SPDX-License-Identifier: GPL-3.0-or-later
#include "triskin/board/i2c_timing.hpp"

#include <gtest/gtest.h>

namespace triskin::board {
namespace {

// By hand for 170 MHz (5.882 ns). Data set-up needs 400 ns in at most 16 units, so a unit is at least 25 ns: prescaler
// 4, 29.41 ns, 14 units. Both edges' synchronization is 2 · (50 + 2 · 5.882) = 123.5 ns; 2376.5 ns remain for low and
// high: 81 units. Low needs 45 (1300 ns), high 21 (600 ns); the spare 15 are shared 10 : 5.
TEST(I2cTiming, WorkedByHandAt170MHz) {
  const auto t = compute_i2c_timing({});
  ASSERT_TRUE(t.has_value());
  EXPECT_EQ(t->prescaler, 4);
  EXPECT_EQ(t->low + 1, 55);
  EXPECT_EQ(t->high + 1, 26);
  EXPECT_EQ(t->data_setup + 1, 14);
  EXPECT_EQ(t->data_delay, 0);
  EXPECT_EQ(t->value(), 4U << 28 | 13U << 20 | 25U << 8 | 54U);
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
  EXPECT_EQ(compute_i2c_timing({170'000'000, 0, 300, 20}).error(), Status::kOutOfRange);
  EXPECT_EQ(compute_i2c_timing({170'000'000, 1'000'000, 300, 20}).error(), Status::kOutOfRange);
  EXPECT_EQ(compute_i2c_timing({4'000'000, 400'000, 300, 20}).error(), Status::kOutOfRange);
  EXPECT_EQ(compute_i2c_timing({170'000'000, 400'000, 900, 20}).error(), Status::kOutOfRange);  // data would be late
}

}  // namespace
}  // namespace triskin::board
