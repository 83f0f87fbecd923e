// SPDX-License-Identifier: GPL-3.0-or-later
#include "triskin/wire/iso_tp.hpp"

#include <gtest/gtest.h>

#include <numeric>

#include "vector_file.hpp"

namespace triskin::wire {
namespace {

using test::from_hex;
using test::vector_rows;

CanFrame frame_of(const std::vector<std::uint8_t>& bytes) {
  CanFrame f;
  f.size = static_cast<std::uint8_t>(bytes.size());
  std::copy(bytes.begin(), bytes.end(), f.data.begin());
  return f;
}

std::vector<std::uint8_t> bytes_of(const CanFrame& f) { return {f.data.begin(), f.data.begin() + f.size}; }

TEST(IsoTp, vectors) {
  for (const auto& row : vector_rows("iso_tp.txt")) {
    IsoTp sender(1, 2, static_cast<std::uint8_t>(std::stoi(row[1]))), receiver(2, 1, static_cast<std::uint8_t>(std::stoi(row[1])));
    const auto message = from_hex(row[2]);
    ASSERT_EQ(sender.send(message, 0), Status::kOk);
    IsoTp::Event last = IsoTp::Event::kNone;
    std::istringstream frames(row[3]);
    for (std::string text; std::getline(frames, text, ';');) {
      text.erase(0, text.find_first_not_of(' '));
      const bool from_receiver = text[0] == '<';
      auto expected = from_hex(from_receiver ? text.substr(1) : text);
      if (from_receiver) expected.resize(8, IsoTp::kPadding);
      const auto frame = (from_receiver ? receiver : sender).transmit(0);
      ASSERT_TRUE(frame.has_value()) << row[0];
      EXPECT_EQ(bytes_of(*frame), expected) << row[0];
      last = (from_receiver ? sender : receiver).receive(*frame, 0);
    }
    EXPECT_EQ(last, IsoTp::Event::kReceived) << row[0];
    EXPECT_EQ(std::vector<std::uint8_t>(receiver.message().begin(), receiver.message().end()), message) << row[0];
    EXPECT_FALSE(sender.sending());
  }
}

// Moves frames between two ends; `meddle` may drop (false) or keep each one.
template <class Meddle>
bool exchange(IsoTp& a, IsoTp& b, Meddle meddle, std::uint64_t until_us = 3'000'000) {
  bool received = false;
  for (std::uint64_t now = 0; now < until_us; now += 500) {
    while (const auto f = a.transmit(now)) {
      if (meddle(*f) && b.receive(*f, now) == IsoTp::Event::kReceived) received = true;
    }
    while (const auto f = b.transmit(now)) {
      if (meddle(*f)) (void)a.receive(*f, now);
    }
    (void)a.tick(now);
    (void)b.tick(now);
  }
  return received;
}

std::vector<std::uint8_t> long_message(std::size_t n) {
  std::vector<std::uint8_t> m(n);
  std::iota(m.begin(), m.end(), std::uint8_t{1});
  return m;
}

TEST(IsoTp, every_length_arrives_on_classic_and_fd) {
  for (const std::uint8_t bytes : std::array<std::uint8_t, 2>{8, 64}) {
    for (std::size_t n = 1; n <= IsoTp::kCapacity; n += n < 140 ? 1 : 97) {
      IsoTp a(1, 2, bytes), b(2, 1, bytes);
      const auto message = long_message(n);
      ASSERT_EQ(a.send(message, 0), Status::kOk);
      EXPECT_TRUE(exchange(a, b, [](const CanFrame&) { return true; }, 2000)) << n;
      EXPECT_TRUE(std::ranges::equal(b.message(), message)) << n;
    }
  }
}

TEST(IsoTp, any_single_lost_frame_ends_both_sides_without_a_wrong_message) {
  const auto message = long_message(100);
  for (int lost = 0; lost < 16; ++lost) {
    IsoTp a(1, 2, 8), b(2, 1, 8);
    ASSERT_EQ(a.send(message, 0), Status::kOk);
    int k = 0;
    EXPECT_FALSE(exchange(a, b, [&](const CanFrame&) { return k++ != lost; })) << lost;
    EXPECT_FALSE(a.sending()) << lost;
    // The connection is usable again.
    ASSERT_EQ(a.send(message, 0), Status::kOk);
    EXPECT_TRUE(exchange(a, b, [](const CanFrame&) { return true; }));
  }
}

TEST(IsoTp, a_repeated_consecutive_frame_is_not_taken_twice) {
  IsoTp b(2, 1, 8);
  (void)b.receive(frame_of({0x10, 20, 1, 2, 3, 4, 5, 6}), 0);
  (void)b.receive(frame_of({0x21, 7, 8, 9, 10, 11, 12, 13}), 0);
  EXPECT_EQ(b.receive(frame_of({0x21, 7, 8, 9, 10, 11, 12, 13}), 0), IsoTp::Event::kFailed);
  EXPECT_EQ(b.receive(frame_of({0x22, 14, 15, 16, 17, 18, 19, 20}), 0), IsoTp::Event::kNone);
}

TEST(IsoTp, refuses_more_than_it_can_hold_with_an_overflow) {
  IsoTp b(2, 1, 8);
  (void)b.receive(frame_of({0x1F, 0xFF, 1, 2, 3, 4, 5, 6}), 0);
  const auto f = b.transmit(0);
  ASSERT_TRUE(f.has_value());
  EXPECT_EQ(f->data[0], 0x32);
  IsoTp a(1, 2, 8);
  EXPECT_EQ(a.send(long_message(IsoTp::kCapacity + 1), 0), Status::kNoSpace);
}

TEST(IsoTp, obeys_block_size_and_gap) {
  IsoTp a(1, 2, 8);
  ASSERT_EQ(a.send(long_message(50), 0), Status::kOk);
  (void)a.transmit(0);
  EXPECT_FALSE(a.transmit(0).has_value());
  (void)a.receive(frame_of({0x30, 2, 10}), 1000);  // blocks of two, 10 ms apart
  EXPECT_TRUE(a.transmit(1000).has_value());
  EXPECT_FALSE(a.transmit(10'999).has_value());
  EXPECT_TRUE(a.transmit(11'000).has_value());
  EXPECT_FALSE(a.transmit(100'000).has_value());  // waits for the next flow control
}

TEST(IsoTp, accepts_frames_without_padding) {
  IsoTp b(2, 1, 8);
  EXPECT_EQ(b.receive(frame_of({0x02, 0x3E, 0x00}), 0), IsoTp::Event::kReceived);
  EXPECT_EQ(b.message().size(), 2U);
}

}  // namespace
}  // namespace triskin::wire
