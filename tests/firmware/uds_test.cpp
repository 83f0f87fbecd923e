// SPDX-License-Identifier: GPL-3.0-or-later
// Runs the conversation of tests/vectors/uds.txt over CAN with the whole application, and tests cases that do not fit
// into it.
#include <gtest/gtest.h>

#include "bench.hpp"
#include "vectors/vector_file.hpp"

namespace triskin::test {
namespace {

// Reads one byte per word; KEY stands for the answer to the last seed.
Message request_of(const std::string& text, std::uint32_t seed) {
  std::istringstream in(text);
  Message m;
  for (std::string word; in >> word;) {
    if (word != "KEY") {
      m.push_back(static_cast<std::uint8_t>(std::stoul(word, nullptr, 16)));
      continue;
    }
    const std::uint32_t key = wire::security_key(seed);
    for (int shift = 24; shift >= 0; shift -= 8) m.push_back(static_cast<std::uint8_t>(key >> shift));
  }
  return m;
}

bool matches(const Message& m, const std::string& pattern) {
  std::istringstream in(pattern);
  std::size_t at = 0;
  for (std::string word; in >> word; ++at) {
    if (at >= m.size() || (word != "??" && m[at] != std::stoul(word, nullptr, 16))) return false;
  }
  return at == m.size();
}

void converse(std::uint8_t frame_bytes) {
  Bench bench;
  bench.power_up();
  std::uint32_t seed = 0;
  const auto vectors = read_vectors("uds.txt");
  ASSERT_GT(vectors.size(), 50U);
  for (const Vector& v : vectors) {
    if (v.has("wait_us")) bench.run(v.number("wait_us"));
    const bool functional = v.has("functional");
    const Message request = request_of(v.one(functional ? "functional" : "request"), seed);
    const Message response = functional ? bench.ask_all(request) : bench.ask(request, frame_bytes);
    EXPECT_TRUE(matches(response, v.one("response"))) << v.name << ": got " << testing::PrintToString(response);
    if (request == Message{0x27, 0x01} && response.size() == 6) seed = ByteReader(Bytes(response).subspan(2)).be32();
  }
}

TEST(UdsVectors, ClassicCan) {
  converse(8);
}
TEST(UdsVectors, CanFd) {
  converse(64);
}

constexpr std::uint8_t kInvalidKey = 0x35, kAttemptsExceeded = 0x36, kTimeDelayNotExpired = 0x37;

void give_three_wrong_keys(Bench& bench) {
  ASSERT_EQ(bench.ask({0x10, 0x03}).at(0), 0x50);
  for (int k = 0; k < 3; ++k) {
    ASSERT_EQ(bench.ask({0x27, 0x01}).at(0), 0x67);
    ASSERT_EQ(bench.ask({0x27, 0x02, 0, 0, 0, 1}), (Message{0x7F, 0x27, k < 2 ? kInvalidKey : kAttemptsExceeded}));
  }
}

// Keeps the session alive for ten seconds; the lock must not depend on its end.
TEST(Uds, ThreeWrongKeysLockForTenSeconds) {
  Bench bench;
  bench.power_up();
  give_three_wrong_keys(bench);
  for (int s = 0; s < 9; ++s) {
    ASSERT_EQ(bench.ask({0x27, 0x01}), (Message{0x7F, 0x27, kTimeDelayNotExpired})) << s << " s";
    bench.run(1'000'000);
  }
  ASSERT_EQ(bench.ask({0x10, 0x03}).at(0), 0x50);
  EXPECT_EQ(bench.ask({0x27, 0x01}), (Message{0x7F, 0x27, kTimeDelayNotExpired})) << "in another session, too";
  bench.run(1'000'000);
  bench.unlock();
  // The count begins anew: the next wrong key is the first of three.
  ASSERT_EQ(bench.ask({0x10, 0x03}).at(0), 0x50);
  ASSERT_EQ(bench.ask({0x27, 0x01}).at(0), 0x67);
  EXPECT_EQ(bench.ask({0x27, 0x02, 0, 0, 0, 1}), (Message{0x7F, 0x27, kInvalidKey}));
}

TEST(Uds, AResetEndsTheLock) {
  Bench bench;
  bench.power_up();
  give_three_wrong_keys(bench);
  EXPECT_EQ(bench.ask({0x27, 0x01}), (Message{0x7F, 0x27, kTimeDelayNotExpired}));
  EXPECT_EQ(bench.ask({0x11, 0x01}), (Message{0x51, 0x01}));
  bench.unlock();
}

// A right key between wrong ones clears the count.
TEST(Uds, WrongKeysCountInARowOnly) {
  Bench bench;
  bench.power_up();
  for (int k = 0; k < 4; ++k) {
    ASSERT_EQ(bench.ask({0x10, 0x03}).at(0), 0x50);
    for (int wrong = 0; wrong < 2; ++wrong) {
      ASSERT_EQ(bench.ask({0x27, 0x01}).at(0), 0x67);
      ASSERT_EQ(bench.ask({0x27, 0x02, 0, 0, 0, 1}), (Message{0x7F, 0x27, kInvalidKey}));
    }
    bench.unlock();
  }
}

// Whatever writes into a flash needs the key, in a session that allows it.
TEST(Uds, WritingAnythingNeedsTheKey) {
  const std::vector<Message> requests{{0x31, 0x01, 0x02, 0x05},                        // activate the table
                                      {0x31, 0x01, 0x02, 0x07, 0x01},                  // protect the loader
                                      {0x31, 0x01, 0x02, 0x07, 0x00},                  // release it
                                      {0x2E, 0xFD, 0x01, 0x05},                        // node address
                                      {0x34, 0x00, 0x44, 0, 1, 0, 0, 0, 0, 0, 0x2C}};  // download
  Bench bench;
  bench.power_up();
  for (const Message& request : requests) {
    ASSERT_EQ(bench.ask({0x10, 0x01}).at(0), 0x50);
    EXPECT_EQ(bench.ask(request), (Message{0x7F, request[0], 0x7F})) << testing::PrintToString(request);
    ASSERT_EQ(bench.ask({0x10, 0x03}).at(0), 0x50);
    EXPECT_EQ(bench.ask(request), (Message{0x7F, request[0], 0x33})) << testing::PrintToString(request);
  }
  // With the key the board is asked; the simulated one has no loader to protect, and the result says that it failed.
  bench.unlock();
  EXPECT_EQ(bench.ask({0x31, 0x01, 0x02, 0x07, 0x01}),
            (Message{0x71, 0x01, 0x02, 0x07, static_cast<std::uint8_t>(Status::kFlashFailed)}));
}

TEST(Uds, ANewSessionLocksAgain) {
  Bench bench;
  bench.power_up();
  bench.unlock();
  ASSERT_EQ(bench.ask({0x2E, 0xFD, 0x05, 0x00}).at(0), 0x6E);
  ASSERT_EQ(bench.ask({0x10, 0x02}).at(0), 0x50);
  EXPECT_EQ(bench.ask({0x2E, 0xFD, 0x05, 0x00}), (Message{0x7F, 0x2E, 0x33}));
}

TEST(Uds, ANewNodeAddressTakesEffectAfterTheAnswer) {
  Bench bench;
  bench.power_up();
  bench.unlock();
  EXPECT_EQ(bench.ask({0x2E, 0xFD, 0x01, 0x00}), (Message{0x7F, 0x2E, 0x31}));
  EXPECT_EQ(bench.ask({0x2E, 0xFD, 0x01, 0x7F}), (Message{0x7F, 0x2E, 0x31}));
  EXPECT_EQ(bench.ask({0x2E, 0xFD, 0x01, 0x42}), (Message{0x6E, 0xFD, 0x01}));
  EXPECT_TRUE(bench.ask({0x3E, 0x00}).empty());
  bench.node = 0x42;
  EXPECT_EQ(bench.ask({0x3E, 0x00}), (Message{0x7E, 0x00}));
  bench.power_up();  // The value also survives a loss of power.
  EXPECT_EQ(bench.ask({0x22, 0xFD, 0x01}), (Message{0x62, 0xFD, 0x01, 0x42}));
}

TEST(Uds, APowerCutAtEveryFlashOperationOfAFlashSession) {
  for (int cut = 0;; ++cut) {
    ASSERT_LT(cut, 100);
    Bench bench;
    place_six(bench);
    bench.power_up();
    layout::PatchImage old = six_modules(), next = six_modules();
    old.module_count = 4;
    next.design_id = 77;
    ASSERT_EQ(bench.flash_table(old), Status::kOk);
    bench.flash.cut_after(cut, FlashDouble<sim::FlashModel>::Tear::kHalf);
    bool lost = false;
    try {
      EXPECT_EQ(bench.flash_table(next), Status::kOk);
    } catch (const sim::PowerLost&) {
      lost = true;
    }
    bench.flash.never_cut();
    bench.power_up();
    const Message m = bench.ask({0x22, 0xFD, 0x02});
    ASSERT_EQ(m.size(), 21U);
    EXPECT_EQ(m[3], 0);
    const std::uint64_t design = ByteReader(Bytes(m).subspan(8)).le64();
    EXPECT_TRUE(design == 77 || design == 6) << "cut " << cut;
    EXPECT_EQ(bench.flash_table(next), Status::kOk);  // The tool runs again.
    if (!lost) {
      EXPECT_GT(cut, 10);
      break;
    }
  }
}

TEST(Stream, FullFramesHaveNoGapsAndRealTimes) {
  Bench bench;
  place_six(bench);
  bench.power_up();
  ASSERT_EQ(bench.flash_table(six_modules()), Status::kOk);
  bench.run(1'000'000);
  bench.unlock();
  ASSERT_EQ(bench.ask({0x2E, 0xFD, 0x05, 0x02}).at(0), 0x6E);
  bench.stream.clear();
  bench.run(1'000'000);
  std::array<int, 6> frames{};
  std::uint32_t last = 0;
  for (const wire::CanFrame& f : bench.stream) {
    const auto t = wire::decode_full(f);
    ASSERT_TRUE(t);
    ++frames.at(t->module);
    EXPECT_EQ(t->valid, layout::kAllTaxels);
    EXPECT_TRUE(last == 0 || t->sample == last || t->sample == last + 1);
    last = t->sample;
    EXPECT_LE(t->device_time_us, bench.now_us);
  }
  for (const int n : frames) EXPECT_NEAR(n, 27, 1);
}

TEST(Stream, IcubFramesFallWithPressure) {
  Bench bench;
  place_six(bench);
  bench.power_up();
  ASSERT_EQ(bench.flash_table(six_modules()), Status::kOk);
  bench.run(1'000'000);
  bench.unlock();
  ASSERT_EQ(bench.ask({0x2E, 0xFD, 0x05, 0x01}).at(0), 0x6E);
  bench.lines[1].chips[0].counts[7] += 400;  // This is module 2.
  bench.run(200'000);
  bench.stream.clear();
  bench.run(60'000);
  ASSERT_GE(bench.stream.size(), 32U);
  const auto t = wire::decode_icub(bench.stream[8], bench.stream[9]);
  ASSERT_TRUE(t);
  EXPECT_EQ(t->module, 4);  // The module has line 1, address 0.
  EXPECT_EQ(t->board, 1);
  for (std::size_t k = 0; k < layout::kTaxelsPerModule; ++k) EXPECT_NEAR(t->value[k], k == 7 ? 145 : 245, 1);
}

TEST(Stream, FullFramesAreRefusedOnAClassicBus) {
  Bench bench;
  bench.can_fd = false;
  bench.power_up();
  bench.unlock();
  EXPECT_EQ(bench.ask({0x2E, 0xFD, 0x05, 0x02}), (Message{0x7F, 0x2E, 0x31}));
}

}  // namespace
}  // namespace triskin::test
