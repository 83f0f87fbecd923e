// SPDX-License-Identifier: GPL-3.0-or-later
#include "triskin/logic/sampling/duplicate_check.hpp"

#include <gtest/gtest.h>

namespace triskin::fw {
namespace {

using Verdict = DuplicateCheck::Verdict;

ad7147::Results all(std::uint16_t value) {
  ad7147::Results results{};
  results.fill(value);
  return results;
}

Verdict compare(DuplicateCheck& check, std::uint16_t positive, std::uint16_t negative) {
  return check.compare(all(positive), all(negative));
}

// 0x9000 and 0x7000 mirror each other at 0x8000, so their sum is 0x10000.
TEST(DuplicateCheck, OneChipPasses) {
  DuplicateCheck check;
  EXPECT_EQ(compare(check, 0x9000, 0x7000), Verdict::kSingle);
}

// Chips at 0x9000 and 0x8FC0 (0x40 apart) read 0x8000 at the positive input (1001 0000 1100 0000 has no bit of
// 1000 1111 1100 0000 but the highest). At the negative one they have 0x7000 and 0x7040, read 0x7000. The sum 0xF000
// lacks 0x1000, more than the 0x40 that are certain.
TEST(DuplicateCheck, TheWiredAndOfTwoChipsIsTooSmall) {
  static_assert((0x9000 & 0x8FC0) == 0x8000 && (0x7000 & 0x7040) == 0x7000);
  DuplicateCheck check;
  EXPECT_EQ(compare(check, 0x8000, 0x7000), Verdict::kSuspected);
}

// Noise explains a deficit of 32 counts, but not one of 33.
TEST(DuplicateCheck, SuspectsAboveAMeanOf32Counts) {
  DuplicateCheck check;
  EXPECT_EQ(compare(check, 0x9000, 0x7000 - 32), Verdict::kSingle);
  EXPECT_EQ(compare(check, 0x9000, 0x7000 - 33), Verdict::kSuspected);
  // A wired AND cannot give a sum that is too large.
  EXPECT_EQ(compare(check, 0x9000, 0x7000 + 500), Verdict::kSingle);
}

// Eleven taxels have no deficit and one has 12 · 32 = 384, so the mean is 32. One more count is too many.
TEST(DuplicateCheck, TheMeanOfAllTaxelsCounts) {
  DuplicateCheck check;
  ad7147::Results negative = all(0x7000);
  negative[3] = 0x7000 - 384;
  EXPECT_EQ(check.compare(all(0x9000), negative), Verdict::kSingle);
  negative[3] = 0x7000 - 385;
  EXPECT_EQ(check.compare(all(0x9000), negative), Verdict::kSuspected);
}

// Taxel 3 reads 0 at the negative input: 0x9000 and 0 lack 0x7000, but say nothing about two chips. The same holds at
// the positive one, where 0 and 0x1000 lack 0xF000.
TEST(DuplicateCheck, TaxelsAtTheEndOfTheirRangeDoNotCount) {
  DuplicateCheck check;
  ad7147::Results positive = all(0x9000), negative = all(0x7000);
  negative[3] = 0;
  EXPECT_EQ(check.compare(positive, negative), Verdict::kSingle);
  positive[3] = 0;
  negative[3] = 0x1000;
  EXPECT_EQ(check.compare(positive, negative), Verdict::kSingle);
  EXPECT_EQ(compare(check, 0xFFFF, 0), Verdict::kSingle);  // There is nothing to compare.
}

TEST(DuplicateCheck, IsCertainAfterThreeInARow) {
  DuplicateCheck check;
  EXPECT_EQ(compare(check, 0x8000, 0x7000), Verdict::kSuspected);
  EXPECT_EQ(compare(check, 0x8000, 0x7000), Verdict::kSuspected);
  EXPECT_EQ(compare(check, 0x9000, 0x7000), Verdict::kSingle);  // A finger was lifted in between.
  EXPECT_EQ(compare(check, 0x8000, 0x7000), Verdict::kSuspected);
  EXPECT_EQ(compare(check, 0x8000, 0x7000), Verdict::kSuspected);
  EXPECT_EQ(compare(check, 0x8000, 0x7000), Verdict::kDuplicate);
}

TEST(DuplicateCheck, ADuplicateIsConfirmedByOneReading) {
  DuplicateCheck check;
  for (int k = 0; k < 3; ++k) (void)compare(check, 0x8000, 0x7000);
  EXPECT_EQ(compare(check, 0x8000, 0x7000), Verdict::kDuplicate);
  EXPECT_EQ(compare(check, 0x9000, 0x7000), Verdict::kSingle);  // The chip has the right straps now.
  EXPECT_EQ(compare(check, 0x8000, 0x7000), Verdict::kSuspected);
}

}  // namespace
}  // namespace triskin::fw
