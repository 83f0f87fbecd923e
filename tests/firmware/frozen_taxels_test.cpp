// SPDX-License-Identifier: GPL-3.0-or-later
#include "triskin/logic/sampling/frozen_taxels.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace triskin::fw {
namespace {

using Taxels = FrozenTaxels::Taxels;

/// Simulates a chip whose first `changing` taxels change by `counts` at every reading while the others stay.
struct Chip {
  FrozenTaxels taxels;
  int counts = 2, number = 0;
  std::uint16_t read(int readings, std::size_t changing) {
    std::uint16_t frozen = 0;
    for (const int end = number + readings; number < end; ++number) {
      Taxels raw{};
      for (std::size_t t = 0; t < raw.size(); ++t)
        raw[t] = static_cast<std::uint16_t>(20'000 + (t < changing ? number % 2 * counts : 0));
      frozen = taxels.add(raw);
    }
    return frozen;
  }
};

// The first reading differs from the zeros before it in all taxels. The next 26 readings have 286 changes, 27 have 297.
TEST(FrozenTaxels, ByHand) {
  Chip one;
  EXPECT_EQ(one.read(1 + 26, 11), 0);
  EXPECT_EQ(one.read(1, 11), 1U << 11);
  EXPECT_EQ(one.read(2, 12), 0);  // The taxel moves again.
  Chip eight;
  EXPECT_EQ(eight.read(1 + 71, 4), 0);  // There are 284 changes.
  EXPECT_EQ(eight.read(1, 4), 0xFF0);
}

// Changes of one count are no jumps. After the first reading 90 have 990 changes, 91 have 1,001.
TEST(FrozenTaxels, AQuietChipNeedsMoreEvidence) {
  Chip quiet;
  quiet.counts = 1;
  EXPECT_EQ(quiet.read(1 + 90, 11), 0);
  EXPECT_EQ(quiet.read(1, 11), 1U << 11);
}

TEST(FrozenTaxels, ANewConfigurationForgets) {
  Chip chip;
  ASSERT_NE(chip.read(40, 11), 0);
  chip.taxels.restart();
  EXPECT_EQ(chip.read(20, 11), 0);
}

TEST(FrozenTaxels, AFingerOnAQuietSkinSaysNothing) {
  Chip chip;
  EXPECT_EQ(chip.read(10'000, 3), 0);
}

// The quietest chip of the ranges in docs/silicon.md: half the noise of decimation 256, each taxel resting at another
// place between two counts and one of them in the middle of a count. Without the jumps a taxel was called frozen in
// 38,079 of these two million readings.
TEST(FrozenTaxels, AQuietChipIsNeverFrozen) {
  std::mt19937_64 random(12);
  std::normal_distribution<double> noise(0.0, 1.5 / 6.6);
  std::uniform_real_distribution<double> place(-0.5, 0.5);
  int frozen = 0;
  for (int chip = 0; chip < 200; ++chip) {
    FrozenTaxels f;
    std::array<double, layout::kTaxelsPerModule> rest{};
    for (double& r : rest) r = 20'000.0 + place(random);
    rest[5] = 20'000.0;
    for (int reading = 0; reading < 10'000; ++reading) {
      Taxels raw{};
      for (std::size_t t = 0; t < raw.size(); ++t)
        raw[t] = static_cast<std::uint16_t>(std::lround(rest[t] + noise(random)));
      frozen += f.add(raw) != 0 ? 1 : 0;
    }
  }
  EXPECT_EQ(frozen, 0);
}

// The same chip with a stuck taxel. The slowest of these rest in the middle of a count in nearly all taxels.
TEST(FrozenTaxels, AFrozenTaxelOfAQuietChipIsFound) {
  std::mt19937_64 random(13);
  std::normal_distribution<double> noise(0.0, 1.5 / 6.6);
  std::uniform_real_distribution<double> place(-0.5, 0.5);
  for (int chip = 0; chip < 50; ++chip) {
    FrozenTaxels f;
    std::array<double, layout::kTaxelsPerModule> rest{};
    for (double& r : rest) r = 20'000.0 + place(random);
    std::uint16_t frozen = 0;
    for (int reading = 0; frozen == 0 && reading < 10'000; ++reading) {
      Taxels raw{};
      for (std::size_t t = 0; t < raw.size(); ++t)
        raw[t] = static_cast<std::uint16_t>(std::lround(rest[t] + (t == 5 ? 0.0 : noise(random))));
      frozen = f.add(raw);
    }
    EXPECT_EQ(frozen, 1U << 5) << "chip " << chip;
  }
}

// Resting values are at the worst place, on a step of the converter, and one taxel of twelve is frozen. Each noise has
// a million readings.
TEST(FrozenTaxels, LiveOnesAreNeverFrozenAndAFrozenOneIsFound) {
  std::mt19937_64 random(11);
  std::normal_distribution<double> normal;
  for (const auto& [peak_to_peak, max_readings] : {std::pair{12.0, 50}, {7.0, 60}, {3.0, 120}}) {
    FrozenTaxels f;
    int first = 0, wrong = 0;
    constexpr int kReadings = 1'000'000;
    for (int k = 1; k <= kReadings; ++k) {
      Taxels raw{};
      for (std::size_t t = 0; t < raw.size(); ++t)
        raw[t] =
            static_cast<std::uint16_t>(std::lround(20'000.0 + (t == 5 ? 0.0 : peak_to_peak / 6.6 * normal(random))));
      const std::uint16_t frozen = f.add(raw);
      wrong += (frozen & ~(1U << 5)) != 0 ? 1 : 0;
      if (first == 0 && frozen != 0) first = k;
    }
    EXPECT_EQ(wrong, 0) << peak_to_peak;
    EXPECT_GT(first, 25) << peak_to_peak;
    EXPECT_LT(first, max_readings) << peak_to_peak;
  }
}

}  // namespace
}  // namespace triskin::fw
