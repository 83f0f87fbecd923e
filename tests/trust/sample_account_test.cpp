// SPDX-License-Identifier: GPL-3.0-or-later
#include "triskin/session/sample_account.hpp"

#include <gtest/gtest.h>

#include <random>

namespace triskin::session {
namespace {

constexpr std::uint64_t kInterval_us = 36'900;

wire::TaxelFrame sample(std::uint32_t number, std::uint32_t dropped = 0, std::uint16_t unread = 0) {
  wire::TaxelFrame t;
  t.sample = number;
  t.device_time_us = number * kInterval_us;
  t.valid = 1;
  t.dropped = dropped;
  t.unread = unread;
  return t;
}

TEST(SampleAccount, a_module_that_was_never_heard_has_lost_all_that_was_due) {
  session::SampleAccount a(1, kInterval_us);
  a.begin(0, {100, 0, 0, 100, 0}, 0);
  a.end(0, {371, 1, 270, 100, 0}, 10'000'000);
  const session::SampleCounts c = a.counts();
  EXPECT_EQ(c.expected, 271U);
  EXPECT_EQ(c.received, 0U);
  EXPECT_EQ(c.unread, 1U);
  EXPECT_EQ(c.dropped, 270U);
  EXPECT_EQ(c.lost(), 271U);
}

TEST(SampleAccount, what_is_none_of_the_lease_counts_for_nothing) {
  session::SampleAccount a(2, kInterval_us);
  EXPECT_FALSE(a.add(sample(8), 0));  // There is no account yet.
  a.begin(0, {10, 0, 0, 10, 0}, 0);
  EXPECT_FALSE(a.add(sample(10), 0));  // The sample came before the account.
  EXPECT_FALSE(a.add(sample(11), 0));  // The number is no multiple.
  EXPECT_TRUE(a.add(sample(12), 0));
  EXPECT_FALSE(a.add(sample(12), 0));  // The sample came twice.
  a.end(0, {14, 0, 0, 14, 1}, 0);
  EXPECT_FALSE(a.complete());
  EXPECT_TRUE(a.add(sample(14), 0));
  EXPECT_FALSE(a.add(sample(16), 0));  // The sample came after the end.
  EXPECT_TRUE(a.complete());
  EXPECT_EQ(a.counts(), (session::SampleCounts{2, 2, 2, 0, 0, 0, 0}));
}

// At 1 kHz the 32 bits of a number wrap after 49 days. The numbers are on both sides of the wrap: 2^32 − 2, 2^32 −
// 1, 0, 1, 2.
TEST(SampleAccount, goes_on_where_the_numbers_wrap) {
  session::SampleAccount a(1, kInterval_us);
  a.begin(0, {0xFFFF'FFFDU, 0, 0, 0, 0}, 0);
  std::uint64_t device_us = 1'000'000'000'000;
  for (const std::uint32_t number : {0xFFFF'FFFEU, 0xFFFF'FFFFU, 0U, 2U}) {
    wire::TaxelFrame t = sample(number);
    t.device_time_us = device_us += kInterval_us;
    EXPECT_TRUE(a.add(t, 0)) << number;
    EXPECT_FALSE(a.add(t, 0)) << number << " again";
  }
  EXPECT_EQ(a.counts().expected, 5U);
  a.end(0, {3, 0, 0, 0, 0}, 0);
  EXPECT_EQ(a.counts().expected, 6U);
  EXPECT_EQ(a.counts().received, 4U);
  EXPECT_EQ(a.counts().on_the_way, 2U);
  EXPECT_FALSE(a.complete());
}

// Multiples of 3 around the wrap, as the controller finds them in its 32 bits, are 2^32 − 4, 2^32 − 1, 0, 3.
TEST(SampleAccount, counts_the_multiples_of_each_round_of_numbers) {
  session::SampleAccount a(3, kInterval_us);
  a.begin(0, {0xFFFF'FFFBU, 0, 0, 0, 0}, 0);
  std::uint64_t device_us = 1'000'000'000'000;
  for (const std::uint32_t number : {0xFFFF'FFFCU, 0xFFFF'FFFFU, 0U, 3U}) {
    wire::TaxelFrame t = sample(number);
    t.device_time_us = device_us += 3 * kInterval_us;
    EXPECT_TRUE(a.add(t, 0)) << number;
  }
  a.end(0, {5, 0, 0, 0, 0}, 0);
  EXPECT_TRUE(a.complete());
  EXPECT_EQ(a.counts(), (session::SampleCounts{4, 4, 4, 0, 0, 0, 0}));
}

TEST(SampleAccount, a_restart_from_a_high_number_is_no_wrap) {
  session::SampleAccount a(1, kInterval_us);
  a.begin(7, {3'000'000'000U, 0, 0, 0, 0}, 0);
  wire::TaxelFrame t = sample(3'000'000'001U);
  t.starts = 7;
  EXPECT_TRUE(a.add(t, 0));
  t = sample(1);
  t.starts = 7;  // The controller forgets how often it started.
  EXPECT_TRUE(a.add(t, 40'000));
  EXPECT_EQ(a.counts().received, 2U);
  EXPECT_LE(a.counts().expected, 3U);
}

// The trailer's 16 and 32 bits wrap too.
TEST(SampleAccount, losses_are_counted_over_the_wraps_of_their_counters) {
  session::SampleAccount a(1, kInterval_us);
  a.begin(0, {10, 0xFFFFU, 0xFFFF'FFFFU, 0, 0}, 0);
  EXPECT_TRUE(a.add(sample(14, 1, 0), 0));  // 11 is unread; 12 and 13 found no room.
  EXPECT_EQ(a.counts(), (session::SampleCounts{4, 1, 1, 1, 2, 0, 0}));
}

// The answer that ends the account was composed before sample 13, but arrived after it.
TEST(SampleAccount, a_sample_that_overtakes_the_last_answer_is_no_restart) {
  session::SampleAccount a(1, kInterval_us);
  a.begin(0, {10, 0, 0, 10, 0}, 0);
  EXPECT_TRUE(a.add(sample(11), 0));
  EXPECT_TRUE(a.add(sample(12), 0));
  EXPECT_TRUE(a.add(sample(13), 0));
  a.end(0, {12, 0, 0, 12, 0}, 0);
  EXPECT_TRUE(a.complete());
  EXPECT_EQ(a.counts(), (session::SampleCounts{3, 3, 3, 0, 0, 0, 0}));
}

TEST(SampleAccount, a_trailer_says_where_a_gap_comes_from) {
  session::SampleAccount a(1, kInterval_us);
  a.begin(0, {65'000, 65'534, 7, 0, 0}, 0);
  EXPECT_TRUE(a.add(sample(65'001, 7, 65'534), 0));
  EXPECT_TRUE(a.add(sample(65'010, 9, 1), 0));  // 8 are missing: 2 found no room, 3 were not read, 3 were lost here.
  EXPECT_EQ(a.counts(), (session::SampleCounts{10, 2, 2, 3, 2, 3, 0}));
}

TEST(SampleAccount, a_controller_that_began_anew_is_counted_by_its_rate) {
  session::SampleAccount a(1, kInterval_us);
  a.begin(3, {10, 0, 0, 10, 0}, 0);
  EXPECT_TRUE(a.add(
      [] {
        auto t = sample(11);
        t.starts = 3;
        return t;
      }(),
      36'900));
  // The controller answers again 100 intervals later with sample 5: 95 were due that nobody took.
  auto late = sample(5);
  late.starts = 1;
  EXPECT_TRUE(a.add(late, 101 * kInterval_us));
  const session::SampleCounts c = a.counts();
  EXPECT_EQ(c.silent, 95U);
  EXPECT_EQ(c.received, 2U);
  EXPECT_EQ(c.on_the_way, 4U);  // The new numbers are 1 … 4.
  EXPECT_EQ(c.expected, 101U);
}

TEST(SampleAccount, a_controller_that_does_not_answer_at_the_end_owes_what_was_due) {
  session::SampleAccount a(1, kInterval_us);
  a.begin(0, {10, 0, 0, 10, 0}, 0);
  EXPECT_TRUE(a.add(sample(11), kInterval_us));
  a.end_silent(28 * kInterval_us);
  EXPECT_EQ(a.counts(), (session::SampleCounts{28, 1, 1, 0, 0, 0, 27}));
}

// Each sample gets a random fate, from which the counts of the controller follow; the account must recover each.
TEST(SampleAccount, agrees_with_the_truth_in_a_thousand_random_streams) {
  for (std::uint64_t seed = 1; seed <= 1000; ++seed) {
    std::mt19937_64 random(seed);
    const int every = 1 + static_cast<int>(random() % 3);
    session::SampleAccount a(every, kInterval_us);
    wire::RowAccount controller{static_cast<std::uint32_t>(random() % 100'000), 70'000, 11, 5, 0};
    a.begin(9, controller, 0);
    session::SampleCounts truth;
    const std::uint32_t last = controller.number + 500;
    while (controller.number < last) {
      ++controller.number;
      if (controller.number % static_cast<std::uint32_t>(every) != 0) continue;
      ++truth.expected;
      switch (random() % 8) {
        case 0:
          ++controller.unread;
          ++truth.unread;
          break;
        case 1:
          ++controller.dropped;
          ++truth.dropped;
          break;
        case 2:
          ++controller.sent;
          ++truth.on_the_way;
          break;
        default: {
          ++controller.sent;
          auto t = sample(controller.number, controller.dropped, static_cast<std::uint16_t>(controller.unread));
          t.starts = 9;
          ASSERT_TRUE(a.add(t, 0));
          ++truth.received;
          ++truth.with_data;
        }
      }
    }
    a.end(9, controller, 0);
    ASSERT_EQ(a.counts(), truth) << "seed " << seed;
  }
}

}  // namespace
}  // namespace triskin::session
