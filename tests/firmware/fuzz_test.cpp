// SPDX-License-Identifier: GPL-3.0-or-later
// Sends random and damaged traffic to the whole application: it must keep answering, and its table must stay while
// nobody unlocks it.
#include <gtest/gtest.h>

#include <random>

#include "bench.hpp"

namespace triskin::test {
namespace {

struct Traffic {
  std::mt19937 random;
  std::uint8_t byte() { return static_cast<std::uint8_t>(random()); }

  wire::CanFrame frame() {
    constexpr std::array<std::uint32_t, 6> kExtended{0x18DA01F1, 0x18DA01F1, 0x18DB33F1,
                                                     0x18E0FFF1, 0x18E1FFF1, 0x18DAF101};
    constexpr std::array<std::uint32_t, 4> kStandard{0x201, 0x701, 0x70F, 0x412};
    wire::CanFrame f;
    f.extended = random() % 4 != 0;
    f.id = f.extended ? kExtended[random() % kExtended.size()] : kStandard[random() % kStandard.size()];
    f.fd = random() % 3 == 0;
    f.size = static_cast<std::uint8_t>(f.fd ? random() % 65 : random() % 9);
    for (std::size_t k = 0; k < f.size; ++k) f.data[k] = byte();
    // The byte makes a plausible ISO-TP head.
    if (random() % 2 == 0) f.data[0] = static_cast<std::uint8_t>(random() % 0x40);
    return f;
  }

  // Returns a service that exists, with random parameters; not the security access, which random bytes could not pass
  // anyway.
  Message request() {
    constexpr std::array<std::uint8_t, 12> kServices{0x10, 0x11, 0x14, 0x19, 0x22, 0x2E,
                                                     0x31, 0x34, 0x35, 0x36, 0x37, 0x3E};
    constexpr std::array<std::uint8_t, 8> kLikely{0x00, 0x01, 0x02, 0x03, 0x05, 0x44, 0xFD, 0xF1};
    Message m{kServices[random() % kServices.size()]};
    const std::size_t size = random() % (random() % 8 == 0 ? 300 : 14);
    for (std::size_t k = 0; k < size; ++k) m.push_back(random() % 3 == 0 ? byte() : kLikely[random() % kLikely.size()]);
    return m;
  }
};

Message table_of(Bench& bench) {
  return bench.ask({0x22, 0xFD, 0x02});
}

TEST(Fuzz, RandomFramesLeaveTheTableAndTheAnswers) {
  Bench bench;
  place_six(bench);
  bench.power_up();
  ASSERT_EQ(bench.flash_table(six_modules()), Status::kOk);
  bench.run(6'000'000);  // The session has ended by now.
  const Message before = table_of(bench);
  Traffic traffic{std::mt19937(11)};
  for (int round = 0; round < 300; ++round) {
    for (int k = 0; k < 100; ++k) {
      bench.controller->receive(traffic.frame());
      bench.run(traffic.random() % 300);
    }
    bench.run(1'100'000);  // Every transfer under way has timed out by now.
    ASSERT_EQ(bench.ask({0x3E, 0x00}), (Message{0x7E, 0x00})) << "round " << round;
  }
  EXPECT_EQ(table_of(bench), before);
  EXPECT_EQ(bench.ask({0x22, 0xFD, 0x01}), (Message{0x62, 0xFD, 0x01, 0x01}));
}

TEST(Fuzz, RandomRequestsAreAnsweredOrRefused) {
  Bench bench;
  place_six(bench);
  bench.power_up();
  ASSERT_EQ(bench.flash_table(six_modules()), Status::kOk);
  bench.run(6'000'000);
  const Message before = table_of(bench);
  Traffic traffic{std::mt19937(12)};
  for (int k = 0; k < 3000; ++k) {
    const Message request = traffic.request(), response = bench.ask(request, k % 2 == 0 ? 8 : 64);
    if (response.empty()) continue;  // The response is suppressed.
    const bool negative = response.size() == 3 && response[0] == 0x7F && response[1] == request[0];
    ASSERT_TRUE(negative || response[0] == request[0] + 0x40) << testing::PrintToString(request);
    // Without the key, no request may change the controller.
    if (request[0] == 0x2E || request[0] == 0x34) {
      ASSERT_TRUE(negative);
    }
  }
  EXPECT_EQ(table_of(bench), before);
}

TEST(Fuzz, UnlockedItRefusesDamagedTables) {
  Bench bench;
  place_six(bench);
  bench.power_up();
  ASSERT_EQ(bench.flash_table(six_modules()), Status::kOk);
  const Message before = table_of(bench);
  std::array<std::uint8_t, layout::kMaxImageBytes> good{};
  const std::size_t size = layout::encode(six_modules(), good).value();
  Traffic traffic{std::mt19937(13)};
  bench.unlock();
  for (int round = 0; round < 200; ++round) {
    auto bytes = good;
    for (std::size_t flips = 1 + traffic.random() % 4; flips > 0; --flips) {
      std::uint8_t& b = bytes[traffic.random() % size];
      b = static_cast<std::uint8_t>(b ^ (1U << traffic.random() % 8));
    }
    if (bytes == good) continue;
    ASSERT_EQ(bench.ask({0x34, 0x00, 0x44, 0, 1, 0, 0, 0, 0, 0, static_cast<std::uint8_t>(size)}).at(0), 0x74);
    std::uint8_t block = 0;
    for (std::size_t at = 0; at < size; at += 64) {
      Message m{0x36, ++block};
      m.insert(m.end(), bytes.begin() + static_cast<std::ptrdiff_t>(at),
               bytes.begin() + static_cast<std::ptrdiff_t>(std::min(at + 64, size)));
      ASSERT_EQ(bench.ask(m), (Message{0x76, block}));
    }
    ASSERT_EQ(bench.ask({0x37}), (Message{0x77}));
    const Message done = bench.ask({0x31, 0x01, 0x02, 0x05});
    ASSERT_EQ(done.size(), 5U);
    EXPECT_NE(done[4], 0);
  }
  EXPECT_EQ(table_of(bench), before);
}

}  // namespace
}  // namespace triskin::test
