// SPDX-License-Identifier: GPL-3.0-or-later
// A seed stands for a design, so the random numbers of the solvers must follow a fixed sequence.
#include "triskin/base/dice.hpp"

#include <gtest/gtest.h>

namespace triskin {
namespace {

// The standard fixes the 10,000th draw of mt19937_64 with seed 5489: 9981545732273789042.
Dice at_draw_10000() {
  Dice dice(5489);
  for (int k = 1; k < 10'000; ++k) (void)dice.unit();
  return dice;
}

TEST(Dice, below_is_the_remainder_of_a_draw) {
  EXPECT_EQ(at_draw_10000().below(1000), 42);
  EXPECT_EQ(at_draw_10000().below(1'000'003), 425864);
}

TEST(Dice, unit_is_the_upper_53_bits_of_a_draw) {
  EXPECT_DOUBLE_EQ(at_draw_10000().unit(), 0.5411006783847329);
}

TEST(Dice, scaled_below_is_the_floor_of_n_times_unit) {
  EXPECT_EQ(at_draw_10000().scaled_below(1000), 541);
}

}  // namespace
}  // namespace triskin
