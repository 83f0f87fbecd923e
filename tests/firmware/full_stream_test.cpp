// SPDX-License-Identifier: GPL-3.0-or-later
#include "triskin/logic/stream/full_stream.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <map>

namespace triskin::fw {
namespace {

wire::TaxelFrame sample(std::uint8_t row, std::uint32_t number) {
  wire::TaxelFrame t;
  t.node_address = 1;
  t.module = row;
  t.sample = number;
  return t;
}

TEST(StreamLeases, one_ends_and_the_other_lasts) {
  StreamLeases leases;
  leases.renew({1, 100, 1, 0}, 0);
  leases.renew({2, 100, 3, 0}, 500'000);
  leases.expire(999'999);
  EXPECT_TRUE(leases.want(1));
  leases.expire(1'000'000);
  EXPECT_TRUE(leases.any());
  EXPECT_FALSE(leases.want(1));
  EXPECT_TRUE(leases.want(3));
  leases.renew({2, 100, 3, 0}, 1'400'000);
  leases.expire(2'399'999);
  EXPECT_TRUE(leases.any());
  leases.renew({2, 0, 3, 0}, 2'000'000);
  EXPECT_FALSE(leases.any());
}

TEST(StreamLeases, a_ninth_finds_no_place_and_a_known_one_keeps_its_own) {
  StreamLeases leases;
  for (std::uint32_t k = 1; k <= 9; ++k) leases.renew({k, 100, 1, 0}, 0);
  wire::StreamAccount account;
  leases.report(account);
  EXPECT_EQ(account.readers, 8);
  EXPECT_FALSE(account.serves(9));
  leases.renew({8, 0, 1, 0}, 0);
  leases.renew({9, 100, 1, 0}, 0);
  leases.report(account);
  EXPECT_TRUE(account.serves(9));
}

TEST(StreamLeases, the_shortest_pace_counts) {
  StreamLeases leases;
  EXPECT_EQ(leases.pace_us(), 0U);
  leases.renew({1, 100, 1, 500}, 0);
  leases.renew({2, 100, 1, 0}, 0);
  leases.renew({3, 100, 1, 400}, 0);
  EXPECT_EQ(leases.pace_us(), 40'000U);
}

// With two rows the port takes nothing. In row 0, samples 1, 2, 5 wait, 3 and 4 were not read, 6 and 7 find no room.
TEST(FullStream, every_sample_is_counted_once) {
  FullStream stream;
  stream.add(sample(0, 1), 2, false);  // Nobody reads the stream.
  stream.restart(3);
  stream.renew({1, 100, 1, 0}, 0);
  for (const std::uint32_t n : {1U, 2U, 5U, 6U, 7U}) stream.add(sample(0, n), 2, false);
  wire::RowAccount row = stream.account(2, 0).modules[0];
  EXPECT_EQ(row, (wire::RowAccount{7, 2, 2, 0, 3}));
  EXPECT_EQ(row.number, row.unread + row.dropped + row.sent + row.waiting);
  ASSERT_TRUE(stream.due(0));
  stream.pop(0);
  stream.add(sample(0, 8), 2, false);
  row = stream.account(2, 0).modules[0];
  EXPECT_EQ(row, (wire::RowAccount{8, 2, 2, 1, 3}));
  stream.pop(0);
  stream.pop(0);
  const auto last = wire::decode_full(stream.front()).value();
  EXPECT_EQ(last.sample, 8U);
  EXPECT_EQ(last.dropped, 2U);
  EXPECT_EQ(last.unread, 2U);
  EXPECT_EQ(last.starts, 3U);
  EXPECT_EQ(stream.dropped(), 2U);
}

TEST(FullStream, only_multiples_count_when_only_they_are_wanted) {
  FullStream stream;
  stream.renew({1, 100, 4, 0}, 0);
  for (std::uint32_t n = 1; n <= 6; ++n) stream.add(sample(0, n), 1, false);
  stream.add(sample(0, 14), 1, false);  // Samples 8 and 12 were not read.
  EXPECT_EQ(stream.account(1, 0).modules[0], (wire::RowAccount{14, 2, 0, 0, 1}));
}

// The port takes a frame per millisecond, but sixteen rows want three, so each gets a third of what it wants.
TEST(FullStream, rows_get_equal_shares_of_a_slow_port) {
  FullStream stream;
  std::map<int, int> sent;
  for (std::uint64_t ms = 0; ms < 4800; ++ms) {
    stream.renew({1, 100, 1, 0}, ms * 1000);
    for (std::uint64_t k = 3 * ms; k < 3 * ms + 3; ++k)
      stream.add(sample(static_cast<std::uint8_t>(k % 16), static_cast<std::uint32_t>(k / 16 + 1)), 16, false);
    if (!stream.due(ms * 1000)) continue;
    ++sent[wire::decode_full(stream.front())->module];
    stream.pop(ms * 1000);
  }
  ASSERT_EQ(sent.size(), 16U);
  for (const auto& [row, n] : sent) EXPECT_NEAR(n, 300, 4) << row;
}

// All rows arrive in the first 16 ms of a sequence of 37 ms, and the pace lets each send every 68 ms: late rows get as
// many turns as early ones. They send in turns, so at any moment two differ by at most one.
TEST(FullStream, rows_get_equal_shares_whenever_their_samples_come) {
  FullStream stream;
  std::array<int, 16> sent{};
  for (std::uint64_t ms = 0; ms < 10'000; ++ms) {
    stream.renew({1, 100, 1, 680}, ms * 1000);
    if (ms % 37 < 16)
      stream.add(sample(static_cast<std::uint8_t>(ms % 37), static_cast<std::uint32_t>(ms / 37 + 1)), 16, false);
    for (; stream.due(ms * 1000); stream.pop(ms * 1000)) ++sent.at(wire::decode_full(stream.front())->module);
  }
  const auto [least, most] = std::ranges::minmax(sent);
  EXPECT_LE(most - least, 1);
  EXPECT_NEAR(least, 10'000 / 68, 2);
}

// A pace of 64 ms for four modules means a frame every 16 ms on average, whatever the port takes.
TEST(FullStream, a_pace_holds_on_the_average) {
  FullStream stream;
  int sent = 0;
  for (std::uint64_t us = 0; us < 10'000'000; us += 1'000) {
    stream.renew({1, 100, 1, 640}, us);
    if (us % 10'000 == 0)
      stream.add(sample(static_cast<std::uint8_t>(us / 10'000 % 4), static_cast<std::uint32_t>(us / 40'000 + 1)), 4,
                 false);
    for (; stream.due(us); stream.pop(us)) ++sent;
  }
  EXPECT_NEAR(sent, 10'000'000 / 16'000, 6);
}

TEST(FullStream, what_waits_for_a_reader_that_went_is_dropped) {
  FullStream stream;
  stream.renew({1, 100, 1, 0}, 0);
  stream.add(sample(0, 1), 1, false);
  stream.tick(1'000'000);
  EXPECT_FALSE(stream.active());
  EXPECT_FALSE(stream.due(1'000'000));
  EXPECT_EQ(stream.account(1, 0).modules[0], (wire::RowAccount{1, 0, 1, 0, 0}));
}

}  // namespace
}  // namespace triskin::fw
