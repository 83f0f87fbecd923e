// SPDX-License-Identifier: GPL-3.0-or-later
#include "triskin/hardware/converters.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <set>
#include <tuple>

#include "converter_properties.hpp"

namespace triskin::hardware {
namespace {

TEST(Converters, NoTwoOfThousandAreAlikeAndEachIsInItsRanges) {
  const Converters drawn{.drawn = true};
  for (const ConverterProperty& p : kConverterProperties) {
    std::set<double> values;
    for (std::uint64_t serial = 1; serial <= 1000; ++serial) {
      const Ad7147Behaviour chip = drawn.of(serial);
      const double value = p.number != nullptr ? chip.*p.number : (chip.*p.flag ? 1.0 : 0.0);
      EXPECT_GE(value, p.drawn_low) << p.key;
      EXPECT_LE(value, p.drawn_high) << p.key;
      values.insert(value);
    }
    EXPECT_EQ(values.size(), p.number != nullptr ? 1000U : 2U) << p.key;
    // The whole of the range is drawn from: a twentieth at each end holds about 50 of 1,000.
    const double edge = (p.drawn_high - p.drawn_low) / 20.0;
    EXPECT_LT(*values.begin(), p.drawn_low + edge) << p.key;
    EXPECT_GT(*values.rbegin(), p.drawn_high - edge) << p.key;
  }
}

TEST(Converters, EqualSerialNumbersGiveEqualChipsAndWhatIsGivenHoldsForAll) {
  Converters converters{.drawn = true};
  EXPECT_EQ(converters.of(7).zero_counts, converters.of(7).zero_counts);
  converters.given.push_back({&kConverterProperties[0], 970.0});
  ASSERT_EQ(kConverterProperties[0].key, "step_counts");
  EXPECT_EQ(converters.of(7).step_counts, 970.0);
  EXPECT_EQ(converters.of(8).step_counts, 970.0);
  EXPECT_NE(converters.of(7).zero_counts, converters.of(8).zero_counts);
}

// Pin p sees 1,000 · p counts.
class Source final : public CapacitanceSource {
 public:
  [[nodiscard]] double counts(int cin, std::uint64_t) const override { return 1000.0 * cin; }
};

// Stage 2 converts pin 2 at an input with an offset of `steps`; the sequence has ended after 50 ms.
std::uint16_t converted(const Ad7147Behaviour& behaviour, bool positive, unsigned steps, std::uint64_t at_us = 50'000) {
  const Source source;
  Ad7147 chip(source);
  chip.set_behaviour(behaviour);
  chip.write_register(0x080 + 8 * 2, static_cast<std::uint16_t>((positive ? 2 : 1) << 4), 0);
  chip.write_register(0x082 + 8 * 2, static_cast<std::uint16_t>(positive ? steps << 8 : steps), 0);
  chip.write_register(0x000, 0x00B0, 0);
  chip.write_register(0x002, 0x8000, 0);
  return chip.read_register(0x00D, at_us);
}

TEST(Converters, EachPropertyChangesTheResultAsItSays) {
  constexpr bool kPositive = true, kNegative = false;
  // 2,000 counts less three steps of 1,000; the steps of the negative input have 990.
  EXPECT_EQ(converted({.step_counts = 1000}, kPositive, 3), 0x8000 + 2000 - 3000);
  EXPECT_EQ(converted({.step_counts = 1000, .neg_step_ratio = 0.99}, kNegative, 3), 0x8000 - 2000 + 2970);
  // Bent by a tenth: 63 steps are 63 * 1,000 * (1 + 0.1 / 2) = 66,150; code 21 has 21 + 0.1 · 441 / 126 = 21.35 steps.
  EXPECT_EQ(converted({.step_counts = 1000, .step_bend = 0.1}, kPositive, 21), 0x8000 + 2000 - 21'350);
  EXPECT_EQ(converted({.zero_counts = -20}, kPositive, 0), 0x8000 + 2000 - 20);
  EXPECT_EQ(converted({.zero_counts = -20}, kNegative, 0), 0x8000 - 2000 - 20);
  EXPECT_EQ(converted({.neg_extra_counts = 200}, kNegative, 0), 0x8000 - 2000 - 200);
  EXPECT_EQ(converted({.neg_extra_counts = 200}, kPositive, 0), 0x8000 + 2000);
  // A gain acts on what is left of the electrode: 2,000 − 3,000 at the positive input, 3,000 − 2,000 at the other.
  EXPECT_EQ(converted({.step_counts = 1000, .neg_gain_ratio = 1.02}, kNegative, 3), 0x8000 + 1020);
  EXPECT_EQ(converted({.step_counts = 1000, .neg_gain_ratio = 1.02}, kPositive, 3), 0x8000 - 1000);
  // Everything is larger by a quarter but the zero error.
  EXPECT_EQ(converted({.step_counts = 1000, .gain = 1.25, .zero_counts = -20}, kPositive, 3), 0x8000 - 1250 - 20);
  EXPECT_EQ(converted({.step_counts = 1000, .gain = 1.25}, kNegative, 3), 0x8000 + 1250);
  // 2,000 of 32,768 counts above the middle are 0.061 of the way: 0.00373 of 5,000 counts are 18.6, at either input.
  EXPECT_EQ(converted({.curve_counts = 5000}, kPositive, 0), 0x8000 + 2000 + 19);
  EXPECT_EQ(converted({.curve_counts = 5000}, kNegative, 0), 0x8000 - 2000 + 19);
}

// A spread of 0.1 changes 2,000 counts by up to 200, at each input by something else.
TEST(Converters, EachStageMayHaveAGainOfItsOwnAtEachInput) {
  const Ad7147Behaviour behaviour{.stage_gain_spread = 0.1, .serial = 5};
  const int positive = converted(behaviour, true, 0) - 0x8000, negative = 0x8000 - converted(behaviour, false, 0);
  EXPECT_NE(positive, 2000);
  EXPECT_NE(positive, negative);
  for (const int counts : {positive, negative}) EXPECT_NEAR(counts, 2000, 200);
}

// Tracks of a line with 1,000 counts to the pad, four lines that are busy for 30 % of the time: of the 3 · 256 samples
// of a result each sees one of either sign, so it deviates by 1,000 · √(1.2 / 768) = 39.5 counts; at decimation 64
// by twice as much. The deviation of 4,000 results is known to 3 · 1 / √(2 · 4,000) = 3.4 %.
TEST(Converters, ABusUnderThePadsIsNoiseThatFallsWithTheDecimation) {
  for (const auto& [decimation, sequence_us, expected] :
       {std::tuple{0U, 36'900U, 39.5}, {1U, 18'400U, 55.9}, {2U, 9'200U, 79.1}}) {
    const Source source;
    Ad7147 chip(source);
    chip.set_behaviour({.bus_coupling_counts = 1000.0, .serial = 11});
    chip.write_register(0x080 + 8 * 2, 2 << 4, 0);
    chip.write_register(0x000, static_cast<std::uint16_t>(0x00B0 | decimation << 8), 0);
    chip.write_register(0x002, 0x8000, 0);
    constexpr int kResults = 4000;
    double squares = 0.0;
    for (int k = 1; k <= kResults; ++k) {
      const double error =
          chip.read_register(0x00D, std::uint64_t{sequence_us} * static_cast<unsigned>(k)) - (0x8000 + 2000.0);
      squares += error * error;
    }
    EXPECT_NEAR(std::sqrt(squares / kResults), expected, 0.034 * expected) << "decimation field " << decimation;
  }
}

// Stage 1 is not connected, and stage 11 converts pin 11, 11,000 counts, before stage 0 converts pin 0, which has none.
TEST(Converters, AStageRemembersTheOneBefore) {
  const Source source;
  Ad7147 chip(source);
  chip.set_behaviour({.stage_memory = 0.01});
  chip.write_register(0x080, 2, 0);
  chip.write_register(0x080 + 8 * 11 + 1, 2 << (2 * (11 - 7)), 0);
  chip.write_register(0x080 + 8 * 2, 2 << 4, 0);
  chip.write_register(0x000, 0x00B0, 0);
  chip.write_register(0x002, 0x8000, 0);
  EXPECT_EQ(chip.read_register(0x00B, 50'000), 0x8000 + 110);
  EXPECT_EQ(chip.read_register(0x00D, 50'000), 0x8000 + 2000);
}

// Stage 2 ends at a quarter of the sequence: 36,900 / 4 = 9,225 µs, and 8 % later at 9,963.
TEST(Converters, AnOscillatorThatIsSlowerByEightPercentEndsItsStagesLater) {
  EXPECT_EQ(converted({.period_error = 0.08}, true, 0, 9'962), 0);
  EXPECT_EQ(converted({.period_error = 0.08}, true, 0, 9'963), 0x8000 + 2000);
}

TEST(Converters, OnlyTheFirstResultsAfterARestartAreOff) {
  const Ad7147Behaviour behaviour{.first_error_counts = 500, .serial = 3};
  EXPECT_NE(converted(behaviour, true, 0, 10'000), 0x8000 + 2000);
  EXPECT_EQ(converted(behaviour, true, 0, 50'000), 0x8000 + 2000);
}

TEST(Converters, AStatusMayNeedToBeEnabled) {
  for (const bool needs : {false, true}) {
    const Source source;
    Ad7147 chip(source);
    chip.set_behaviour({.status_needs_enable = needs});
    chip.write_register(0x000, 0x00B0, 0);
    chip.write_register(0x002, 0x8000, 0);
    EXPECT_EQ(chip.read_register(0x00A, 3 * 3075), needs ? 0x000 : 0x007);
    chip.write_register(0x007, 0x0FFF, 3 * 3075);
    EXPECT_EQ(chip.read_register(0x00A, 4 * 3075), 0x008);
  }
}

}  // namespace
}  // namespace triskin::hardware
