// SPDX-License-Identifier: GPL-3.0-or-later
#include "triskin/logic/sampling/configuration_check.hpp"

#include <gtest/gtest.h>

namespace triskin::fw {
namespace {

ad7147::Results middle() {
  ad7147::Results results{};
  results.fill(0x8000);
  return results;
}

TEST(ConfigurationCheck, IsDueAfterEachSixteenthReading) {
  ConfigurationCheck check;
  check.confirmed();
  for (int reading = 1; reading <= 15; ++reading) EXPECT_FALSE(check.due_after_reading()) << reading;
  EXPECT_TRUE(check.due_after_reading());
  EXPECT_TRUE(check.due_after_reading());  // The line had no time until now.
  check.confirmed();
  for (int reading = 1; reading <= 15; ++reading) EXPECT_FALSE(check.due_after_reading()) << reading;
  EXPECT_TRUE(check.due_after_reading());
}

TEST(ConfigurationCheck, IsDueAfterTheSecondSequenceThatCouldNotBeRead) {
  ConfigurationCheck check;
  check.confirmed();
  EXPECT_FALSE(check.due_after_missing());
  EXPECT_FALSE(check.due());
  EXPECT_TRUE(check.due_after_missing());
  EXPECT_TRUE(check.due());
  EXPECT_TRUE(check.due_after_reading());
  check.confirmed();
  EXPECT_FALSE(check.due());
}

TEST(ConfigurationCheck, IsNeededBeforeAResultAtAnEndOfItsRangeCounts) {
  ConfigurationCheck check;
  ad7147::Results results = middle();
  EXPECT_FALSE(check.needed_for(results));
  results[11] = 0;
  EXPECT_TRUE(check.needed_for(results));
  EXPECT_TRUE(check.needed_for(results));
  results[11] = 1;
  results[0] = 0xFFFF;
  EXPECT_TRUE(check.needed_for(results));
  results[0] = 0xFFFE;
  EXPECT_FALSE(check.needed_for(results));
}

TEST(ConfigurationCheck, IsNeededOnceWhenRequired) {
  ConfigurationCheck check;
  check.require();
  EXPECT_TRUE(check.needed_for(middle()));
  EXPECT_FALSE(check.needed_for(middle()));
}

}  // namespace
}  // namespace triskin::fw
