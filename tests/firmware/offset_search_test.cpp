// SPDX-License-Identifier: GPL-3.0-or-later
#include "triskin/logic/sampling/offset_search.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <random>

namespace triskin::fw {
namespace {

using Polarity = Ad7147::Polarity;

/// Simulates twelve electrodes at a converter of ± 8 pF with an offset of `step_pf` per step.
struct Electrodes {
  std::array<double, 12> pf{};
  double step_pf = 0.32;
  [[nodiscard]] ad7147::Results read(const ad7147::Offsets& offsets, Polarity polarity) const {
    ad7147::Results r{};
    for (std::size_t t = 0; t < r.size(); ++t) {
      const double counts = (pf[t] - step_pf * offsets[t]) * 32768.0 / 8.0;
      const double code = 32768.0 + (polarity == Polarity::kPositive ? counts : -counts);
      r[t] = static_cast<std::uint16_t>(std::clamp(std::lround(code), 0L, 65535L));
    }
    return r;
  }
  /// Returns the number of readings until the offsets are found.
  [[nodiscard]] int settle(OffsetSearch& search, Polarity polarity) const {
    int readings = 1;
    while (search.adjust(read(search.offsets(), polarity), polarity)) ++readings;
    return readings;
  }
};

// By hand: 2 pF at 31 steps of 0.32 pF is 7.92 pF or 32,440 counts too little: 28.9 steps of 1,122. With 2 steps left
// the electrode has 1.36 pF or 5,571 counts too much. So 29 steps are 38,011 counts, one 1,310: 4 steps more, 0.08 pF
// remain.
TEST(OffsetSearch, MeasuresTheStepFromTwoReadings) {
  Electrodes e;
  e.pf.fill(2.0);
  OffsetSearch search;
  search.begin();
  EXPECT_EQ(search.offsets(), (ad7147::Offsets{31, 31, 31, 31, 31, 31, 31, 31, 31, 31, 31, 31}));
  EXPECT_EQ(e.read(search.offsets(), Polarity::kNegative)[0], 32768 + 32440);
  EXPECT_TRUE(search.adjust(e.read(search.offsets(), Polarity::kNegative), Polarity::kNegative));
  EXPECT_EQ(search.outside(), 0x0FFF);
  EXPECT_EQ(search.offsets()[0], 2);
  EXPECT_EQ(e.read(search.offsets(), Polarity::kNegative)[0], 32768 - 5571);
  EXPECT_TRUE(search.adjust(e.read(search.offsets(), Polarity::kNegative), Polarity::kNegative));
  EXPECT_EQ(search.step_counts(), 1310);
  EXPECT_EQ(search.offsets()[0], 6);
  EXPECT_EQ(e.read(search.offsets(), Polarity::kNegative)[0], 32768 - 328);
  EXPECT_FALSE(search.adjust(e.read(search.offsets(), Polarity::kNegative), Polarity::kNegative));
  EXPECT_EQ(search.outside(), 0);
}

TEST(OffsetSearch, EveryElectrodeOf2To18PfRestsInTheMiddleAfterThreeReadings) {
  for (const Polarity polarity : {Polarity::kNegative, Polarity::kPositive}) {
    for (int centi_pf = 200; centi_pf <= 1800; ++centi_pf) {
      Electrodes e;
      e.pf.fill(centi_pf / 100.0);
      OffsetSearch search;
      search.begin();
      ASSERT_LE(e.settle(search, polarity), 3) << centi_pf;
      ASSERT_EQ(search.outside(), 0) << centi_pf;
      ASSERT_NEAR(e.read(search.offsets(), polarity)[0], 32768, 1311) << centi_pf;
    }
  }
}

// Steps from 900 counts (970 were measured) to 1,400 (1,311 by the data sheet); 63 of the smallest are 13.84 pF, and
// the middle third reaches 2.67 pF farther.
TEST(OffsetSearch, StepsOfAnySizeCostReadingsOnly) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> pf(2.0, 16.5);
  for (const double step_pf : {900 / 4096.0, 970 / 4096.0, 0.29, 0.32, 1400 / 4096.0}) {
    for (int n = 0; n < 300; ++n) {
      Electrodes e;
      e.step_pf = step_pf;
      std::ranges::generate(e.pf, [&] { return pf(random); });
      OffsetSearch search;
      search.begin();
      ASSERT_LE(e.settle(search, Polarity::kNegative), OffsetSearch::kMaxRounds);
      ASSERT_EQ(search.outside(), 0) << step_pf;
    }
  }
}

TEST(OffsetSearch, KnownOffsetsStayWhileTheirTaxelRestsInTheMiddleThird) {
  Electrodes e;
  e.pf.fill(10.0);
  ad7147::Offsets known{};
  known.fill(31);
  known[3] = 24;  // At 2.32 pF off, the value is still inside.
  known[4] = 22;  // The offset is 2.96 pF off.
  OffsetSearch search;
  search.begin(known);
  EXPECT_EQ(e.settle(search, Polarity::kPositive), 2);
  known[4] = 22 + 11;  // 12,124 counts are 10.8 steps of 1,122.
  EXPECT_EQ(search.offsets(), known);
  EXPECT_EQ(search.outside(), 0);
}

TEST(OffsetSearch, WhatNoOffsetReachesIsNamed) {
  Electrodes e;
  e.pf.fill(10.0);
  e.pf[2] = 40.0;    // This electrode is shorted to the shield.
  e.pf[7] = -100.0;  // There is no electrode.
  OffsetSearch search;
  search.begin();
  EXPECT_LE(e.settle(search, Polarity::kNegative), OffsetSearch::kMaxRounds);
  EXPECT_EQ(search.outside(), 1U << 2 | 1U << 7);
  EXPECT_EQ(search.offsets()[2], 63);
  EXPECT_EQ(search.offsets()[7], 0);
  // An offset that is already known costs no further reading.
  const ad7147::Offsets found = search.offsets();
  search.begin(found);
  EXPECT_EQ(e.settle(search, Polarity::kNegative), 1);
  EXPECT_EQ(search.outside(), 1U << 2 | 1U << 7);
}

// Two chips that answer together never settle, but the search must end all the same.
TEST(OffsetSearch, EndsWhenTheResultsDoNotFollow) {
  OffsetSearch search;
  search.begin();
  ad7147::Results low{}, high{};
  low.fill(100);
  high.fill(65'000);
  int readings = 1;
  while (search.adjust(readings % 2 == 0 ? low : high, Polarity::kNegative)) ++readings;
  EXPECT_EQ(readings, OffsetSearch::kMaxRounds);
}

}  // namespace
}  // namespace triskin::fw
