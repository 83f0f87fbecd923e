// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include "triskin/board/i2c_timing.hpp"

namespace triskin::board {
namespace {

// By hand for 170 MHz (5.882 ns): both edges' synchronization is 2 · (50 + 2 · 5.882) = 123.5 ns, so 2376.5 ns remain for low and
// high: 405 clocks; low 222 and high 103 are needed, the spare 80 is shared 54 : 26 → 276 clocks low. That does not fit 8 bits, so
// prescaler 1 (11.765 ns): 203 units; 111 + 51, spare 41 → 28 : 13 → low 139, high 64.
TEST(I2cTiming, WorkedByHandAt170MHz) {
  const auto t = compute_i2c_timing({});
  ASSERT_TRUE(t.has_value());
  EXPECT_EQ(t->prescaler, 1);
  EXPECT_EQ(t->low + 1, 139);
  EXPECT_EQ(t->high + 1, 64);
  EXPECT_EQ(t->data_setup + 1, 4 + 30);  // 400 ns / 11.765 ns = 34 units: does not fit 4 bits
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
