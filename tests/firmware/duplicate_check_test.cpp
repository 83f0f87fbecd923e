// SPDX-License-Identifier: GPL-3.0-or-later
#include "triskin/logic/sampling/duplicate_check.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "triskin/logic/sampling/offset_search.hpp"

namespace triskin::fw {
namespace {

using Verdict = DuplicateCheck::Verdict;
using ad7147::Offsets;
using ad7147::Results;

template <class Array>
Array all(int value) {
  Array array{};
  array.fill(static_cast<typename Array::value_type>(value));
  return array;
}

// Twelve different offsets, 20 … 42.
Offsets spread() {
  Offsets offsets{};
  for (std::size_t t = 0; t < offsets.size(); ++t) offsets[t] = static_cast<std::uint8_t>(20 + 2 * t);
  return offsets;
}

// Results at the used input that make the sum of taxel t deviate from 65,536 by deviation(t).
template <class Deviation>
Results used_with(const Results& other, Deviation deviation) {
  Results used{};
  for (std::size_t t = 0; t < used.size(); ++t)
    used[t] = static_cast<std::uint16_t>(0x10000 - other[t] + static_cast<int>(std::lround(deviation(t))));
  return used;
}

float residual(const Offsets& offsets, auto deviation) {
  const auto other = all<Results>(0x9000);
  return DuplicateCheck::residual_counts(other, used_with(other, deviation), offsets);
}

// The third reading ran the sampler with such chips, and each was refused: the mean of the sums lacks more than 32.
TEST(DuplicateCheck, OneRealChipPasses) {
  const Offsets o = spread();
  EXPECT_EQ(residual(o, [](std::size_t) { return 0.0; }), 0.0F);
  // A zero error of −20 counts lowers both readings; 49 fF at the negative input are 200 counts.
  EXPECT_EQ(residual(o, [](std::size_t) { return -40.0; }), 0.0F);
  EXPECT_EQ(residual(o, [](std::size_t) { return -200.0; }), 0.0F);
  // Steps of 1,311 counts that are a hundredth smaller at one input lack 13.11 a step; rounding leaves half a count.
  EXPECT_LT(residual(o, [&](std::size_t t) { return -13.11 * o[t]; }), 0.5F);
  // Steps of which each is larger than the one before, by 2 counts.
  EXPECT_LT(residual(o, [&](std::size_t t) { return -1.0 * o[t] * o[t]; }), 0.5F);
}

// Chips at 0x9000 and 0x8FC0 (0x40 apart) read 0x8000 at the positive input (1001 0000 0000 0000 has no bit of
// 1000 1111 1100 0000 but the highest). At the negative one they have 0x7000 and 0x7040, read 0x7000. The sum 0xF000
// lacks 0x1000. Where the taxels of both rest alike nothing is lacking.
TEST(DuplicateCheck, TheWiredAndOfTwoChipsFitsNoParabola) {
  static_assert((0x9000 & 0x8FC0) == 0x8000 && (0x7000 & 0x7040) == 0x7000);
  DuplicateCheck check;
  auto positive = all<Results>(0x9000);
  for (const std::size_t t : {0U, 2U, 3U, 5U, 8U}) positive[t] = 0x8000;
  EXPECT_EQ(check.compare(positive, all<Results>(0x7000), spread()), Verdict::kSuspected);
}

// With equal offsets only the mean is taken away. Six of twelve sums deviate by 240 counts: the first of them does not
// count, five of eleven leave a mean of 1200 / 11 = 109.1, and residuals of (5 · 130.9 + 6 · 109.1) / 11 = 119.0.
// 244 counts instead leave 119.0 · 244 / 240 = 121.0.
TEST(DuplicateCheck, SuspectsAboveAMeanResidualOf120Counts) {
  const auto six = [](double counts) { return [counts](std::size_t t) { return t % 2 == 0 ? counts : 0.0; }; };
  EXPECT_NEAR(residual(all<Offsets>(31), six(240.0)), 119.0F, 0.1F);
  EXPECT_NEAR(residual(all<Offsets>(31), six(244.0)), 121.0F, 0.1F);
  DuplicateCheck check;
  const auto other = all<Results>(0x9000);
  EXPECT_EQ(check.compare(other, used_with(other, six(240.0)), all<Offsets>(31)), Verdict::kSingle);
  EXPECT_EQ(check.compare(other, used_with(other, six(244.0)), all<Offsets>(31)), Verdict::kSuspected);
}

// Of eleven remaining taxels one has 3,000 counts: (2727.3 + 10 · 272.7) / 11 = 495.9.
TEST(DuplicateCheck, OneTaxelMayBePressedOrStuck) {
  EXPECT_EQ(residual(all<Offsets>(31), [](std::size_t t) { return t == 4 ? 3000.0 : 0.0; }), 0.0F);
  EXPECT_NEAR(residual(all<Offsets>(31), [](std::size_t t) { return t == 4 || t == 9 ? 3000.0 : 0.0; }), 495.9F, 0.1F);
}

// A taxel that is shorted to the shield is at opposite ends at the two inputs, where it says nothing; seven of them
// leave too few. At the same end at both inputs only two chips can be, and one such taxel may be stuck.
TEST(DuplicateCheck, TaxelsAtTheEndOfTheirRangeSayLittle) {
  Results other = all<Results>(0x9000), used = all<Results>(0x7000);
  for (std::size_t t = 0; t < 7; ++t) {
    other[t] = 0xFFFF;
    used[t] = 0;
  }
  used[10] = 0x6000;
  used[11] = 0x6500;
  EXPECT_EQ(DuplicateCheck::residual_counts(other, used, spread()), 0.0F);
  other[0] = 0;
  EXPECT_EQ(DuplicateCheck::residual_counts(other, used, spread()), 0.0F);
  other[1] = 0;
  EXPECT_EQ(DuplicateCheck::residual_counts(other, used, spread()), INFINITY);
}

Verdict compare(DuplicateCheck& check, bool two) {
  const auto other = all<Results>(0x9000);
  const auto lacks = [two](std::size_t t) { return two && t % 2 == 0 ? -0x1000 : 0; };
  return check.compare(other, used_with(other, lacks), spread());
}

TEST(DuplicateCheck, IsCertainAfterThreeInARow) {
  DuplicateCheck check;
  EXPECT_EQ(compare(check, true), Verdict::kSuspected);
  EXPECT_EQ(compare(check, true), Verdict::kSuspected);
  EXPECT_EQ(compare(check, false), Verdict::kSingle);  // A hand was lifted in between.
  EXPECT_EQ(compare(check, true), Verdict::kSuspected);
  EXPECT_EQ(compare(check, true), Verdict::kSuspected);
  EXPECT_EQ(compare(check, true), Verdict::kDuplicate);
}

TEST(DuplicateCheck, ADuplicateIsConfirmedByOneReading) {
  DuplicateCheck check;
  for (int k = 0; k < 3; ++k) (void)compare(check, true);
  EXPECT_EQ(compare(check, true), Verdict::kDuplicate);
  EXPECT_EQ(compare(check, false), Verdict::kSingle);  // The chip has the right straps now.
  EXPECT_EQ(compare(check, true), Verdict::kSuspected);
}

// A chip drawn from the ranges of docs/silicon.md, all at once: steps of 900 … 1,400 counts, those of the other input
// up to a tenth off, each DAC bent by up to 5 % and each code off by up to 5 % of a step, zero error ± 200 counts,
// path 0 … 400 counts with ± 20 from pin to pin, noise of twice the data sheet's 12 counts peak to peak.
class DrawnChip {
 public:
  DrawnChip(std::mt19937& random, const std::array<double, 12>& electrodes) : random_(random), counts_(electrodes) {
    const double step = in(900, 1400), ratio = in(0.9, 1.1);
    draw_dac(positive_, step);
    draw_dac(negative_, step * ratio);
    zero_ = in(-200, 200);
    const double path = in(0, 400);
    for (double& p : path_) p = path + in(-20, 20);
  }
  Results read(const Offsets& offsets, Ad7147::Polarity polarity) {
    const bool positive = polarity == Ad7147::Polarity::kPositive;
    Results r{};
    for (std::size_t t = 0; t < r.size(); ++t) {
      const double counts =
          positive ? counts_[t] - positive_[offsets[t]] : -(counts_[t] + path_[t] - negative_[offsets[t]]);
      r[t] =
          static_cast<std::uint16_t>(std::clamp(std::lround(32768.0 + zero_ + counts + noise_(random_)), 0L, 65535L));
    }
    return r;
  }

 private:
  double in(double low, double high) { return std::uniform_real_distribution<double>(low, high)(random_); }
  void draw_dac(std::array<double, 64>& dac, double step) {
    const double bend = in(-0.05, 0.05);
    for (std::size_t o = 0; o < dac.size(); ++o) {
      const auto x = static_cast<double>(o);
      dac[o] = step * (x + bend * x * x / 126.0 + in(-0.05, 0.05));
    }
  }
  std::mt19937& random_;
  std::array<double, 12> counts_, path_{};
  std::array<double, 64> positive_{}, negative_{};
  double zero_ = 0.0;
  std::normal_distribution<double> noise_{0.0, 24.0 / 6.6};
};

std::array<double, 12> electrodes(std::mt19937& random, double low_pf, double high_pf) {
  std::uniform_real_distribution<double> pf(low_pf, high_pf);
  std::array<double, 12> counts{};
  std::ranges::generate(counts, [&] { return 4096.0 * pf(random); });
  return counts;
}

// Searches the offsets at the positive input, as ChipSetup does, reads the negative one and judges.
template <class Read>
float judged(Read read) {
  OffsetSearch search;
  search.begin();
  Results other = read(search.offsets(), Ad7147::Polarity::kPositive);
  while (search.adjust(other, Ad7147::Polarity::kPositive)) other = read(search.offsets(), Ad7147::Polarity::kPositive);
  return DuplicateCheck::residual_counts(other, read(search.offsets(), Ad7147::Polarity::kNegative), search.offsets());
}

constexpr int kDraws = 4000;

TEST(DuplicateCheck, NoneOf4000DrawnChipsIsRefused) {
  std::mt19937 random(20261128);
  float largest = 0.0F;
  for (int k = 0; k < kDraws; ++k) {
    DrawnChip chip(random, electrodes(random, 2.0, 16.0));
    largest = std::max(largest, judged([&](const Offsets& o, Ad7147::Polarity p) { return chip.read(o, p); }));
  }
  RecordProperty("largest_residual", std::to_string(largest));
  EXPECT_LT(largest, DuplicateCheck::kMaxResidual_counts);
}

// Electrodes of equal boards resemble each other: each within `alike_pf` of the other chip's. `alike_pf` of 14 is any.
float smallest_of_two(double alike_pf, unsigned seed) {
  std::mt19937 random(seed);
  float smallest = INFINITY;
  for (int k = 0; k < kDraws; ++k) {
    const auto first = electrodes(random, 2.0, 16.0);
    auto second = electrodes(random, -alike_pf, alike_pf);
    for (std::size_t t = 0; t < second.size(); ++t)
      second[t] = std::clamp(first[t] + second[t], 4096.0 * 2.0, 4096.0 * 16.0);
    DrawnChip a(random, first), b(random, second);
    smallest = std::min(smallest, judged([&](const Offsets& o, Ad7147::Polarity p) {
                          Results r = a.read(o, p);
                          const Results other = b.read(o, p);
                          for (std::size_t t = 0; t < r.size(); ++t) r[t] = static_cast<std::uint16_t>(r[t] & other[t]);
                          return r;
                        }));
  }
  return smallest;
}

TEST(DuplicateCheck, EachOf4000DrawnPairsIsFound) {
  for (const double alike_pf : {14.0, 1.0, 0.244}) {
    const float smallest = smallest_of_two(alike_pf, 7);
    RecordProperty("smallest_residual_within_" + std::to_string(alike_pf) + "_pf", std::to_string(smallest));
    EXPECT_GT(smallest, DuplicateCheck::kMaxResidual_counts) << "electrodes within " << alike_pf << " pF";
  }
}

}  // namespace
}  // namespace triskin::fw
