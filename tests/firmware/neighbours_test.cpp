// SPDX-License-Identifier: GPL-3.0-or-later
// Tests by hand when a controller searches beyond its border, and when it gives modules back.
#include "triskin/logic/switched/neighbours.hpp"

#include <gtest/gtest.h>

namespace triskin::fw {
namespace {

constexpr std::uint8_t kOwn = 5;  // Its turn is the second one, since 5 mod 4 = 1.
constexpr wire::Reach kOffer{9, 0b0110, 0, 0}, kNothing{9, 0, 0, 0};

TEST(Neighbours, look_once_at_an_offer_in_their_turn) {
  Neighbours n;
  EXPECT_FALSE(n.begin_look(0));
  n.receive(kOffer, kOwn, false, 1'000'000);
  EXPECT_EQ(n.look_us(), 1'200'000U);
  EXPECT_TRUE(n.begin_look(1'200'000));
  EXPECT_EQ(n.look_us(), Neighbours::kNever_us);
  n.receive(kOffer, kOwn, true, 2'000'000);  // A repeated offer changes nothing.
  EXPECT_EQ(n.look_us(), Neighbours::kNever_us);
  n.receive({9, 0b0010, 0, 0}, kOwn, true, 2'500'000);  // One module is back without our help.
  EXPECT_EQ(n.look_us(), Neighbours::kNever_us);
  n.receive({9, 0b1010, 0, 0}, kOwn, true, 3'000'000);  // The owner offers one more.
  EXPECT_EQ(n.look_us(), 3'200'000U);
}

TEST(Neighbours, give_back_at_once_when_the_owner_asks) {
  Neighbours n;
  n.receive(kOffer, kOwn, false, 0);
  EXPECT_TRUE(n.begin_look(200'000));
  n.receive(kNothing, kOwn, true, 5'000'000);
  EXPECT_EQ(n.look_us(), 5'000'000U);
  EXPECT_FALSE(n.begin_look(5'000'100));  // This closes the open search.
  EXPECT_EQ(n.look_us(), Neighbours::kNever_us);
  n.receive(kNothing, kOwn, false, 6'000'000);  // There is nothing to do, because nothing was adopted.
  EXPECT_EQ(n.look_us(), Neighbours::kNever_us);
}

TEST(Neighbours, keep_away_until_the_owner_has_looked) {
  Neighbours n;
  n.receive(kOffer, kOwn, false, 0);
  n.receive({10, 1, 0, 0}, kOwn, false, 0);  // This is a second owner.
  EXPECT_TRUE(n.begin_look(200'000));
  n.receive(kNothing, kOwn, true, 1'000'000);
  EXPECT_FALSE(n.begin_look(1'000'000));
  EXPECT_EQ(n.look_us(), 1'300'000U);     // The modules of the second owner have this time.
  EXPECT_FALSE(n.begin_look(1'100'000));  // A search for another reason meanwhile adopts nothing.
  EXPECT_TRUE(n.begin_look(1'300'000));
  n.receive(kNothing, kOwn, true, 2'000'000);  // The owner repeats this after a restart.
  EXPECT_EQ(n.look_us(), Neighbours::kNever_us);
  n.receive(kOffer, kOwn, true, 2'000'000);  // The owner has not got these modules back.
  EXPECT_EQ(n.look_us(), 2'200'000U);
}

// Modules at the border are read first, and those behind them after each neighbour has had its turn.
TEST(Neighbours, look_further_after_the_turns_of_all) {
  Neighbours n;
  n.receive(kOffer, kOwn, false, 1'000'000);
  EXPECT_TRUE(n.begin_look(1'200'000));
  EXPECT_EQ(n.layers(), 1);
  n.look_further(1'220'000);
  EXPECT_EQ(n.look_us(), 1'620'000U);
  EXPECT_TRUE(n.begin_look(1'620'000));
  EXPECT_EQ(n.layers(), 16);
  // The owner offers one more, and adopted modules that are read already stay.
  n.receive({9, 0b1110, 0, 0}, kOwn, true, 3'000'000);
  EXPECT_TRUE(n.begin_look(3'200'000));
  EXPECT_EQ(n.layers(), 16);
  n.receive(kNothing, kOwn, true, 4'000'000);
  n.receive(kOffer, kOwn, false, 5'000'000);
  EXPECT_TRUE(n.begin_look(5'200'000));
  EXPECT_EQ(n.layers(), 1);
  n.receive(kNothing, kOwn, false, 5'210'000);  // The message arrives during the search.
  n.look_further(5'220'000);
  EXPECT_EQ(n.look_us(), Neighbours::kNever_us);
}

// A controller that adopted nothing because its own patch was incomplete tries again when it is complete.
TEST(Neighbours, are_looked_at_again_while_they_offer) {
  Neighbours n;
  n.look_again(100'000);
  EXPECT_EQ(n.look_us(), Neighbours::kNever_us);
  n.receive(kOffer, kOwn, false, 200'000);
  EXPECT_TRUE(n.begin_look(400'000));
  n.look_again(1'000'000);
  EXPECT_EQ(n.look_us(), 1'100'000U);
}

TEST(Neighbours, forget_an_owner_that_falls_silent) {
  Neighbours n;
  n.receive(kOffer, kOwn, false, 0);
  EXPECT_TRUE(n.begin_look(200'000));
  n.tick(true, 2'999'999);
  EXPECT_EQ(n.look_us(), Neighbours::kNever_us);
  n.tick(true, 3'000'000);
  EXPECT_EQ(n.look_us(), 3'000'000U);
  EXPECT_FALSE(n.begin_look(3'000'000));
}

TEST(Neighbours, a_fifth_owner_waits_for_a_place) {
  Neighbours n;
  for (std::uint8_t node = 1; node <= 4; ++node) n.receive({node, 1, 0, 0}, kOwn, false, 0);
  EXPECT_TRUE(n.begin_look(200'000));
  n.receive({6, 1, 0, 0}, kOwn, true, 300'000);
  EXPECT_EQ(n.look_us(), Neighbours::kNever_us);
  n.receive({2, 0, 0, 0}, kOwn, true, 400'000);
  EXPECT_FALSE(n.begin_look(400'000));
  n.receive({6, 1, 0, 0}, kOwn, false, 1'000'000);  // The offer is repeated each second.
  EXPECT_EQ(n.look_us(), 700'000U);                 // The search after the pause comes first.
}

}  // namespace
}  // namespace triskin::fw
