// SPDX-License-Identifier: GPL-3.0-or-later
#include "triskin/logic/sequence_clock.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace triskin::fw {
namespace {

// A chip whose sequence lasts `nominal` with an oscillator error, and a controller that looks up to 60 µs late and is wrong about
// the moment of its look by up to 20 µs.
struct Chip {
  double period_us, started_us = 1'000'000.0;
  std::mt19937 random{7};
  double uniform(double most) { return std::uniform_real_distribution<double>(0.0, most)(random); }
  void look(SequenceClock& clock, int sequence) {
    const auto at = clock.look_us() + SequenceClock::kStatusRead_us + static_cast<std::uint64_t>(uniform(60.0));
    clock.looked(at, static_cast<double>(at) + uniform(20.0) >= end(sequence));
  }
  [[nodiscard]] double end(int sequence) const { return started_us + sequence * period_us; }
};

TEST(SequenceClock, FindsAndKeepsThePeriodOfEveryOscillator) {
  for (const std::uint32_t nominal : {9'200U, 18'400U, 36'900U}) {
    for (const int ppm : {-40'000, -39'500, -3'000, 0, 500, 12'000, 40'000}) {
      Chip chip{nominal * (1.0 + ppm * 1e-6)};
      SequenceClock clock;
      clock.start(static_cast<std::uint64_t>(chip.started_us) + 70, nominal);
      for (int n = 1; n < 20'000; ++n) {
        const double error = static_cast<double>(clock.end_us()) - chip.end(n);
        if (!clock.locked()) {
          ASSERT_LE(std::abs(error), (nominal / 12.0 + 585 - 135) / 2 - 50) << "the window of a burst, sequence " << n << " of " << nominal << " us, " << ppm << " ppm";
        } else {
          ASSERT_LE(error, 260.0) << n << ", " << ppm;
          ASSERT_GE(error, -225.0) << n << ", " << ppm;
        }
        if (clock.look_wanted()) chip.look(clock, n);
        ASSERT_FALSE(clock.uncertain());
        clock.next();
      }
      EXPECT_TRUE(clock.locked());
      EXPECT_NEAR(static_cast<double>(clock.period_us()), chip.period_us, 8.0);
    }
  }
}

TEST(SequenceClock, FollowsAnOscillatorThatWarmsUp) {
  Chip chip{9'200.0};
  SequenceClock clock;
  clock.start(static_cast<std::uint64_t>(chip.started_us), 9'200);
  double end = chip.end(1);
  for (int n = 1; n < 30'000; ++n) {  // 2 % in four and a half minutes
    const double error = static_cast<double>(clock.end_us()) - end;
    if (clock.locked()) {
      ASSERT_LE(std::abs(error), 260.0) << n;
    }
    if (clock.look_wanted()) {
      const auto at = clock.look_us() + SequenceClock::kStatusRead_us + static_cast<std::uint64_t>(chip.uniform(60.0));
      clock.looked(at, static_cast<double>(at) >= end);
    }
    clock.next();
    end += 9'200.0 * (1.0 + 0.02 * n / 30'000);
  }
}

TEST(SequenceClock, WindowOfABurstLiesBetweenTheStages) {
  SequenceClock clock;
  clock.start(1'000'000, 9'200);
  EXPECT_EQ(clock.end_us(), 1'009'200U - 45);  // the start is noticed a little late
  // The last result is read 585 µs after the start, the first one 135: E − 585 … E + 766 − 135 by the clock of the chip.
  EXPECT_GE(clock.read_us(), 1'009'200U - 585);
  EXPECT_LE(clock.last_start_us(), 1'009'200U + 766 - 135);
  EXPECT_LT(clock.read_us(), clock.last_start_us());
}

TEST(SequenceClock, IsUncertainAfterContradictionsWithoutEndOrWithoutLooks) {
  SequenceClock clock;
  clock.start(1'000'000, 9'200);
  Chip chip{9'200.0};
  int n = 1;
  for (; n < 100; ++n, clock.next()) {
    if (clock.look_wanted()) chip.look(clock, n);
  }
  ASSERT_FALSE(clock.uncertain());
  for (int k = 0; k < 40 && !clock.uncertain(); ++k, clock.next()) {
    if (clock.look_wanted()) clock.looked(clock.look_us() + SequenceClock::kStatusRead_us, false);
  }
  EXPECT_TRUE(clock.uncertain());
  clock.restart(9'000'000);
  EXPECT_FALSE(clock.uncertain());
  for (int k = 0; k < 40; ++k) clock.next();
  EXPECT_TRUE(clock.uncertain());
}

}  // namespace
}  // namespace triskin::fw
