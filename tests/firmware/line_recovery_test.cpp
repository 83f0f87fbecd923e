// SPDX-License-Identifier: GPL-3.0-or-later
#include "triskin/logic/sampling/line_recovery.hpp"

#include <gtest/gtest.h>

namespace triskin::fw {
namespace {

TEST(LineRecovery, LeavesTheLineAloneForASecondAfterThreeInARow) {
  LineRecovery recovery;
  for (int k = 1; k <= 3; ++k) {
    EXPECT_TRUE(recovery.held_low(1'000));
    recovery.recovered(false);
    EXPECT_TRUE(recovery.stuck());
    EXPECT_EQ(recovery.paused_until_us(), 0U);
  }
  EXPECT_FALSE(recovery.held_low(2'000));
  EXPECT_TRUE(recovery.stuck());
  EXPECT_EQ(recovery.paused_until_us(), 1'002'000U);
  EXPECT_EQ(recovery.count(), 3U);
  recovery.end_pause();
  EXPECT_EQ(recovery.paused_until_us(), 0U);
  EXPECT_TRUE(recovery.held_low(1'002'000));  // Three more pulses follow.
  EXPECT_EQ(recovery.count(), 4U);
}

TEST(LineRecovery, ATransferThatEndsBeginsTheCountAnew) {
  LineRecovery recovery;
  for (int k = 0; k < 10; ++k) {
    EXPECT_TRUE(recovery.held_low(1'000)) << k;
    recovery.recovered(true);
    EXPECT_FALSE(recovery.stuck());
    recovery.line_works();
  }
  EXPECT_EQ(recovery.count(), 10U);
}

TEST(LineRecovery, ALineThatLetsGoOnlyForAMomentIsLeftAloneToo) {
  LineRecovery recovery;
  for (int k = 0; k < 3; ++k) {
    EXPECT_TRUE(recovery.held_low(1'000));
    recovery.recovered(true);  // The next transfer finds the line held low again.
  }
  EXPECT_FALSE(recovery.held_low(1'000));
  EXPECT_TRUE(recovery.stuck());
}

TEST(LineRecovery, ARestartForgetsThePauseButNotTheCount) {
  LineRecovery recovery;
  for (int k = 0; k < 3; ++k) (void)recovery.held_low(1'000);
  EXPECT_FALSE(recovery.held_low(1'000));
  recovery.restart();
  EXPECT_FALSE(recovery.stuck());
  EXPECT_EQ(recovery.paused_until_us(), 0U);
  EXPECT_TRUE(recovery.held_low(1'000));
  EXPECT_EQ(recovery.count(), 4U);
}

}  // namespace
}  // namespace triskin::fw
