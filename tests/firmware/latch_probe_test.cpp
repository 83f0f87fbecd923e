// SPDX-License-Identifier: GPL-3.0-or-later
#include "triskin/logic/sampling/latch_probe.hpp"

#include <gtest/gtest.h>

namespace triskin::fw {
namespace {

using wire::Latching;

ad7147::Results results(std::uint16_t value) {
  ad7147::Results r{};
  for (std::size_t t = 0; t < r.size(); ++t) r[t] = static_cast<std::uint16_t>(value + t);
  return r;
}

TEST(LatchProbe, ResultsOfTheNewConfigurationInMidSequenceChangeStageByStage) {
  LatchProbe probe;
  EXPECT_TRUE(probe.wanted());
  probe.store(results(33'010));
  probe.compare(results(32'500), results(33'000));
  EXPECT_EQ(probe.latching(), Latching::kEachStage);
  EXPECT_FALSE(probe.wanted());
}

TEST(LatchProbe, ResultsOfTheOldOneChangeAtTheEnd) {
  LatchProbe probe;
  probe.store(results(32'510));
  probe.compare(results(32'500), results(33'000));
  EXPECT_EQ(probe.latching(), Latching::kEndOfSequence);
  probe.forget();
  EXPECT_TRUE(probe.wanted());
}

// Stages 5 to 11 may or may not have ended, so they do not count.
TEST(LatchProbe, OnlyTheFirstStagesCount) {
  LatchProbe probe;
  ad7147::Results middle = results(33'000);
  for (std::size_t t = LatchProbe::kStages; t < middle.size(); ++t) middle[t] = results(32'000)[t];
  probe.store(middle);
  probe.compare(results(32'000), results(33'000));
  EXPECT_EQ(probe.latching(), Latching::kEachStage);
}

TEST(LatchProbe, NoiseAndAFingerGiveNoVerdict) {
  LatchProbe probe;
  probe.store(results(32'768));
  probe.compare(results(32'766), results(32'770));  // The values are too near to each other.
  EXPECT_TRUE(probe.wanted());
  probe.store(results(32'800));
  probe.compare(results(32'000), results(34'000));  // A finger arrived.
  EXPECT_TRUE(probe.wanted());
}

TEST(LatchProbe, TakesAChipWithoutVerdictForTheUsualOne) {
  LatchProbe probe;
  for (int n = 1; n < LatchProbe::kMaxProbes; ++n) {
    probe.compare(results(100), results(60'000));  // No value was read in mid-sequence.
    EXPECT_TRUE(probe.wanted()) << n;
  }
  probe.compare(results(100), results(60'000));
  EXPECT_EQ(probe.latching(), Latching::kEachStage);
}

TEST(LatchProbe, AReadingOfAnEarlierSequenceDoesNotCount) {
  LatchProbe probe;
  probe.store(results(32'500));
  probe.skip();
  probe.compare(results(32'500), results(33'000));
  EXPECT_TRUE(probe.wanted());
}

}  // namespace
}  // namespace triskin::fw
