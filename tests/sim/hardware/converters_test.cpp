// SPDX-License-Identifier: GPL-3.0-or-later
#include "triskin/hardware/converters.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <set>

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
