// SPDX-License-Identifier: GPL-3.0-or-later
#include "triskin/logic/sampling/module_reading.hpp"

#include <gtest/gtest.h>

namespace triskin::fw {
namespace {

using wire::ModuleState;

ad7147::Results middle() {
  ad7147::Results results{};
  results.fill(0x8000);
  return results;
}

TEST(ModuleReading, AllTaxelsInsideTheirRangeAreValid) {
  ModuleReading sample;
  sample.store(middle(), 0);
  EXPECT_EQ(sample.state, ModuleState::kOk);
  EXPECT_EQ(sample.valid, 0x0FFF);
  EXPECT_EQ(sample.raw[5], 0x8000);
}

// Taxels 0 and 11 are at the ends: 0x0FFF − 0x0801 = 0x07FE.
TEST(ModuleReading, ATaxelAtAnEndOfItsRangeIsSaturated) {
  ModuleReading sample;
  ad7147::Results results = middle();
  results[0] = 0;
  results[11] = 0xFFFF;
  sample.store(results, 0);
  EXPECT_EQ(sample.state, ModuleState::kSaturated);
  EXPECT_EQ(sample.valid, 0x07FE);
}

TEST(ModuleReading, AFrozenTaxelIsNotValid) {
  ModuleReading sample;
  sample.store(middle(), 0x0010);
  EXPECT_EQ(sample.state, ModuleState::kFrozen);
  EXPECT_EQ(sample.valid, 0x0FEF);
}

// A taxel that rests at the end of its range does not change either, but it counts as saturated, not frozen.
TEST(ModuleReading, SaturatedComesBeforeFrozen) {
  ModuleReading sample;
  ad7147::Results results = middle();
  results[4] = 0;
  sample.store(results, 0x0010);
  EXPECT_EQ(sample.state, ModuleState::kSaturated);
  EXPECT_EQ(sample.valid, 0x0FEF);
}

TEST(ModuleReading, AFailureTakesTheValidityAndKeepsTheCounts) {
  ModuleReading sample;
  sample.store(middle(), 0);
  sample.publish(1'000);
  sample.store_failure(ModuleState::kAbsent);
  sample.unheard = 2;
  sample.fresh = false;
  sample.publish(2'000);
  EXPECT_EQ(sample.state, ModuleState::kAbsent);
  EXPECT_EQ(sample.valid, 0);
  EXPECT_EQ(sample.raw[5], 0x8000);
  EXPECT_EQ(sample.number, 2U);
  EXPECT_EQ(sample.time_us, 2'000U);
  EXPECT_TRUE(sample.fresh);
  EXPECT_EQ(sample.unheard, 0);
}

}  // namespace
}  // namespace triskin::fw
