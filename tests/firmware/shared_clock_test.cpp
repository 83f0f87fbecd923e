// SPDX-License-Identifier: GPL-3.0-or-later
#include "triskin/drivers/shared_clock.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <vector>

namespace triskin::fw {
namespace {

// Simulates a line whose transfers end when the test says so.
struct FakeLine final : I2cLine {
  void start(std::uint8_t address, Bytes, std::span<std::uint8_t>) override {
    busy = true;
    addresses.push_back(address);
    ++under_way;
    worst = std::max(worst, under_way);
  }
  std::optional<Status> poll() override {
    if (!busy || !ready) return std::nullopt;
    busy = ready = false;
    --under_way;
    return outcome;
  }
  [[nodiscard]] std::uint64_t started_us() const override { return 1'000; }
  [[nodiscard]] std::uint64_t ended_us() const override { return 1'700; }
  Status recover() override {
    EXPECT_EQ(under_way, 0) << "its pulses would go into a transfer";
    ++recoveries;
    return Status::kOk;
  }
  bool busy = false, ready = false;
  Status outcome = Status::kOk;
  int recoveries = 0;
  std::vector<std::uint8_t> addresses;
  inline static int under_way = 0, worst = 0;
};

class OneClock : public ::testing::Test {
 protected:
  void SetUp() override { FakeLine::under_way = FakeLine::worst = 0; }
  void start(std::size_t k, std::uint8_t address) { clock.line(k).start(address, {}, {}); }
  std::array<FakeLine, 4> lines;
  SharedClock<FakeLine> clock{std::span(lines)};
};

TEST_F(OneClock, OneTransferAtATimeInTheOrderOfTheirStarts) {
  start(2, 0x2C);
  start(0, 0x2D);
  start(3, 0x2E);
  EXPECT_TRUE(lines[2].busy);
  EXPECT_FALSE(lines[0].busy || lines[3].busy);
  EXPECT_FALSE(clock.line(0).poll());
  EXPECT_FALSE(clock.line(2).poll());
  lines[2].ready = true;
  EXPECT_FALSE(clock.line(3).poll()) << "only its own end is reported";
  EXPECT_EQ(clock.line(2).poll(), Status::kOk);
  EXPECT_FALSE(clock.line(2).poll()) << "reported once";
  EXPECT_TRUE(lines[0].busy) << "it was started before line 3";
  start(2, 0x2F);
  lines[0].ready = true;
  EXPECT_EQ(clock.line(0).poll(), Status::kOk);
  EXPECT_TRUE(lines[3].busy);
  lines[3].outcome = Status::kBusError;
  lines[3].ready = true;
  EXPECT_EQ(clock.line(3).poll(), Status::kBusError);
  EXPECT_TRUE(lines[2].busy);
  EXPECT_EQ(lines[2].addresses, (std::vector<std::uint8_t>{0x2C, 0x2F}));
  EXPECT_EQ(FakeLine::worst, 1);
  EXPECT_EQ(clock.line(3).ended_us(), 1'700U);
}

// The line is held low: the transfer of another line ends first, and its outcome is not lost.
TEST_F(OneClock, ABusClearWaitsForTheTransferUnderWay) {
  start(1, 0x2C);
  lines[1].ready = true;
  EXPECT_EQ(clock.line(0).recover(), Status::kOk);
  EXPECT_EQ(lines[0].recoveries, 1);
  EXPECT_EQ(clock.line(1).poll(), Status::kOk);
  start(1, 0x2D);
  start(2, 0x2E);
  lines[1].ready = true;
  EXPECT_EQ(clock.line(0).recover(), Status::kOk);
  EXPECT_TRUE(lines[2].busy) << "the next one goes on after the bus clear";
}

TEST_F(OneClock, ALongTimeOfTransfersKeepsTheOrder) {
  for (int k = 0; k < 1'000; ++k) {
    const std::size_t first = static_cast<std::size_t>(k) % 4, second = (first + 1) % 4;
    start(first, 1);
    start(second, 2);
    lines[first].ready = true;
    ASSERT_EQ(clock.line(first).poll(), Status::kOk);
    ASSERT_TRUE(lines[second].busy);
    lines[second].ready = true;
    ASSERT_EQ(clock.line(second).poll(), Status::kOk);
  }
  EXPECT_EQ(FakeLine::worst, 1);
}

}  // namespace
}  // namespace triskin::fw
