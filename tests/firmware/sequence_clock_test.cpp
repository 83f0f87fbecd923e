// SPDX-License-Identifier: GPL-3.0-or-later
#include "triskin/logic/sampling/sequence_clock.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace triskin::fw {
namespace {

// What a data sheet that gives a tolerance would allow, instead of the ± 12 % of SequenceClock.
constexpr std::uint32_t kTypical_percent = 4;

// Simulates a chip whose sequences last `period_us` each, changing by the fraction `wander` per second, and a
// controller whose stamps are wrong by up to 20 µs.
struct Chip {
  double period_us, wander_per_s = 0.0, end_us = 0.0;
  SequenceClock clock{};
  std::mt19937 random{7};
  [[nodiscard]] double uniform(double least, double most) {
    return std::uniform_real_distribution<double>(least, most)(random);
  }
  void start(double at_us, std::uint32_t nominal_us, std::uint32_t tolerance_percent = kTypical_percent) {
    end_us = at_us + period_us;
    clock.start(static_cast<std::uint64_t>(at_us + uniform(-20.0, 20.0)), nominal_us, wire::Latching::kEachStage,
                tolerance_percent);
  }
  void next(int count = 1) {
    for (int k = 0; k < count; ++k) {
      period_us *= 1.0 + wander_per_s * period_us * 1e-6;
      end_us += period_us;
    }
    clock.next(static_cast<std::uint32_t>(count));
  }
  // Refines as the sampler does: at every third stage, up to 60 µs later than ideal.
  void refine() {
    for (int stage = 2; stage < 12 && clock.refinement_wanted(); stage += 3) {
      const auto at = static_cast<std::uint64_t>(static_cast<double>(clock.stage_end_us(stage)) + uniform(0.0, 60.0));
      clock.refine(at, stage,
                   static_cast<double>(at) + uniform(-20.0, 20.0) >= end_us - (11 - stage) * period_us / 12.0);
    }
  }
  // Returns true if a burst anywhere in the window reads twelve results of one sequence.
  [[nodiscard]] bool whole() const {
    return static_cast<double>(clock.read_us() + SequenceClock::kLastResult_us) >= end_us &&
           static_cast<double>(clock.last_start_us() + SequenceClock::kFirstResult_us) <= end_us + period_us / 12.0;
  }
};

constexpr std::uint32_t kNominals_us[] = {9'200, 18'400, 36'900};

TEST(SequenceClock, EveryWindowIsWholeWithEveryOscillator) {
  for (const std::uint32_t nominal : kNominals_us) {
    for (const int ppm : {-40'000, -39'500, -3'000, 0, 500, 12'000, 40'000}) {
      Chip chip{nominal * (1.0 + ppm * 1e-6)};
      chip.start(1'000'000, nominal);
      for (int n = 1; n < 20'000; ++n, chip.next()) {
        ASSERT_TRUE(chip.whole()) << n << " of " << nominal << " us, " << ppm << " ppm";
        ASSERT_LT(chip.clock.read_us() + (n == 1 ? 300 : 500), chip.clock.last_start_us())
            << n << " of " << nominal << " us, " << ppm << " ppm";
        chip.refine();
        ASSERT_FALSE(chip.clock.uncertain());
        if (n >= 8) {
          ASSERT_GE(chip.clock.may_pass(8), 8U) << n;
        }
      }
      EXPECT_NEAR(static_cast<double>(chip.clock.period_us()), chip.period_us, 3.0);
    }
  }
}

// While the oscillator may be off by 12 % there is no window; readings of the status in the first sequence open it.
TEST(SequenceClock, AnyOscillatorIsKnownAfterItsFirstSequence) {
  for (const std::uint32_t nominal : kNominals_us) {
    for (const int percent : {-12, -10, -8, -5, 5, 8, 10, 12}) {
      Chip chip{nominal * (1.0 + percent / 100.0)};
      chip.start(1'000'000, nominal, SequenceClock::kTolerance_percent);
      EXPECT_GT(chip.clock.read_us(), chip.clock.last_start_us());
      for (int n = 1; n < 1'000; ++n, chip.next()) {
        chip.refine();
        ASSERT_LT(chip.clock.read_us() + 200, chip.clock.last_start_us()) << n << ": " << nominal << " us, " << percent;
        ASSERT_TRUE(chip.whole()) << n << ": " << nominal << " us, " << percent << " %";
        ASSERT_FALSE(chip.clock.uncertain());
      }
      EXPECT_NEAR(static_cast<double>(chip.clock.period_us()), chip.period_us, 3.0);
    }
  }
}

TEST(SequenceClock, FollowsAnOscillatorThatWarmsUp) {
  Chip chip{9'200.0, 72e-6};  // The period drifts by 2 % in four and a half minutes.
  chip.start(1'000'000, 9'200);
  for (int n = 1; n < 30'000; ++n, chip.next()) {
    ASSERT_TRUE(chip.whole()) << n;
    chip.refine();
    ASSERT_FALSE(chip.clock.uncertain()) << n;
  }
}

TEST(SequenceClock, LeavesSequencesOutOnceThePeriodIsKnown) {
  for (const std::uint32_t nominal : kNominals_us) {
    for (const std::uint32_t every : {3U, 50U, 255U}) {
      Chip chip{nominal * 0.967};
      chip.start(1'000'000, nominal);
      int readings = 0;
      int n = 1;
      for (; n < 20'000; ++readings) {
        ASSERT_TRUE(chip.whole()) << n << " of " << nominal << " us, every " << every;
        chip.refine();
        const std::uint32_t passed = chip.clock.may_pass(every);
        n += static_cast<int>(passed);
        chip.next(static_cast<int>(passed));
      }
      EXPECT_LE(readings, n / std::min<int>(static_cast<int>(every), 12) + 8) << nominal << " us, every " << every;
    }
  }
}

TEST(SequenceClock, WithoutLooksTheWindowShrinksUntilItAsksForANewStart) {
  Chip chip{9'200.0};
  chip.start(1'000'000, 9'200);
  for (int n = 1; n < 5; ++n, chip.next()) chip.refine();
  int n = 0;
  for (; n < 1000 && !chip.clock.uncertain(); ++n, chip.next()) ASSERT_TRUE(chip.whole()) << n;
  EXPECT_LT(n, 1000);
  EXPECT_LT(chip.clock.read_us(), chip.clock.last_start_us());
  chip.end_us = 9'000'000.0 + chip.period_us;
  chip.clock.restart(9'000'000);
  EXPECT_FALSE(chip.clock.uncertain());
  EXPECT_TRUE(chip.whole());
}

// Another chip took its place, or one restarted unseen.
TEST(SequenceClock, IsUncertainWhenLooksContradictAgainAndAgain) {
  Chip chip{9'200.0};
  chip.start(1'000'000, 9'200);
  for (int n = 1; n < 100; ++n, chip.next()) chip.refine();
  chip.period_us *= 1.05;
  for (int n = 0; n < 200 && !chip.clock.uncertain(); ++n, chip.next()) {
    const std::uint64_t at = chip.clock.end_us() + 200;
    chip.clock.refine(at, 11, static_cast<double>(at) >= chip.end_us);
  }
  EXPECT_TRUE(chip.clock.uncertain());
  chip.clock.restart(9'000'000);  // No earlier knowledge remains.
  EXPECT_FALSE(chip.clock.uncertain());
  EXPECT_EQ(chip.clock.may_pass(2), 1U);
  EXPECT_NEAR(static_cast<double>(chip.clock.doubt_us()), 0.24 * 9'200 + 50, 2.0);
}

// By hand: started at 1 s, ± 4 % and 25 µs, the end lies in 1 008 807 … 1 009 593.
TEST(SequenceClock, WindowOfABurstLiesBetweenTheStages) {
  SequenceClock clock;
  clock.start(1'000'000, 9'200, wire::Latching::kEachStage, kTypical_percent);
  EXPECT_EQ(clock.end_us(), 1'009'200U);
  EXPECT_NEAR(static_cast<double>(clock.doubt_us()), 786.0, 1.0);
  EXPECT_NEAR(static_cast<double>(clock.read_us()), 1'009'593 + 25 - 585, 1.0);
  EXPECT_NEAR(static_cast<double>(clock.last_start_us()), 1'008'807 + 736 - 135 - 25, 1.0);
  EXPECT_NEAR(static_cast<double>(clock.stage_end_us(5)), 1'009'200 - 6 * 9'200 / 12.0, 1.0);
  clock.refine(1'009'200, 11, true);
  EXPECT_NEAR(static_cast<double>(clock.doubt_us()), 9'225 - 8'807, 1.0);
}

// By hand for the same start: after the latest end, and before the earliest next one, 8,832 µs after the earliest end.
TEST(SequenceClock, ResultsThatChangeAtTheEndAreReadBetweenTwoEnds) {
  for (const wire::Latching latching : {wire::Latching::kEndOfSequence, wire::Latching::kUnknown}) {
    SequenceClock clock;
    clock.start(1'000'000, 9'200, latching, kTypical_percent);
    EXPECT_NEAR(static_cast<double>(clock.read_us()), 1'009'593 + 25 - 135, 1.0);
    EXPECT_NEAR(static_cast<double>(clock.last_start_us()), 1'008'807 + 8'832 - 585 - 25, 1.0);
    clock.set_latching(wire::Latching::kEachStage);
    EXPECT_NEAR(static_cast<double>(clock.read_us()), 1'009'593 + 25 - 585, 1.0);
  }
}

}  // namespace
}  // namespace triskin::fw
