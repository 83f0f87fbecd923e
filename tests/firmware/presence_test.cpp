// SPDX-License-Identifier: GPL-3.0-or-later
#include "triskin/logic/sampling/presence.hpp"

#include <gtest/gtest.h>

namespace triskin::fw {
namespace {

// The attempt was due at 10,000, but the line had time only at 10,400; there is no answer at 10,430. The next one is at
// 19,200, not at 19,600.
TEST(Presence, AttemptsStayInStepWhenTheLineIsLate) {
  Presence presence;
  presence.ask_at(10'000);
  presence.failed(10'400, 10'430, 9'200);
  EXPECT_EQ(presence.ask_us(), 19'200U);
  presence.failed(19'200, 19'230, 9'200);
  EXPECT_EQ(presence.ask_us(), 28'400U);
}

// The line had no time for more than a period: at 25,030, 10,000 + 9,200 has passed, so 25,000 + 9,200 counts.
TEST(Presence, AnAttemptThatWaitedForAPeriodSetsTheStepAnew) {
  Presence presence;
  presence.ask_at(10'000);
  presence.failed(25'000, 25'030, 9'200);
  EXPECT_EQ(presence.ask_us(), 34'200U);
}

TEST(Presence, IsLostRecentlyForATenthOfASecond) {
  Presence presence;
  EXPECT_FALSE(presence.lost_recently(50'000));  // The module was never lost.
  presence.lost(1'000'000);
  EXPECT_TRUE(presence.lost_recently(1'000'000));
  EXPECT_TRUE(presence.lost_recently(1'099'999));
  EXPECT_FALSE(presence.lost_recently(1'100'000));
}

}  // namespace
}  // namespace triskin::fw
