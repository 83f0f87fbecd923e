// SPDX-License-Identifier: GPL-3.0-or-later
// Sampling that begins anew while a transfer runs waits for its end: a line takes one transfer at a time.
#include <gtest/gtest.h>

#include "triskin/logic/sampling/sampler.hpp"

namespace triskin::fw {
namespace {

/// Each transfer takes 100 µs and is not acknowledged.
class SlowLine final : public I2cLine {
 public:
  void start(std::uint8_t, Bytes, std::span<std::uint8_t>) override {
    EXPECT_FALSE(busy) << "the last transfer has not ended";
    busy = true;
    started = now_us;
    ++starts;
  }
  std::optional<Status> poll() override {
    if (!busy || now_us < started + 100) return std::nullopt;
    busy = false;
    return Status::kBusError;
  }
  [[nodiscard]] std::uint64_t started_us() const override { return started; }
  [[nodiscard]] std::uint64_t ended_us() const override { return started + 100; }
  Status recover() override { return Status::kOk; }
  bool busy = false;
  int starts = 0;
  std::uint64_t now_us = 0, started = 0;
};

TEST(SamplerRestart, waits_for_the_transfer_that_runs) {
  const std::array<layout::ModuleRow, 1> rows{layout::ModuleRow{1, 0, 0, 0, layout::kNoParent, layout::kCable}};
  std::array<ModuleReading, 1> readings{};
  OffsetBook offsets{};
  SlowLine line, other;
  LineSampler sampler;
  const LineSampler::Patch patch{rows, readings, offsets};
  sampler.begin(line, 0, patch, {}, 0);
  sampler.step(0);
  ASSERT_TRUE(line.busy);
  ASSERT_EQ(line.starts, 1);

  sampler.begin(line, 0, patch, {}, 10);
  for (line.now_us = 10; line.now_us < 100; line.now_us += 10) {
    sampler.step(line.now_us);
    EXPECT_EQ(sampler.next_event_us(line.now_us), UINT64_MAX) << "the end of the transfer is what it waits for";
  }
  EXPECT_EQ(line.starts, 1);
  line.now_us = 100;
  sampler.step(100);
  sampler.step(100);
  EXPECT_EQ(line.starts, 2) << "then it goes on";

  // Another line has no transfer that could be waited for.
  other.now_us = 110;
  sampler.begin(other, 0, patch, {}, 110);
  sampler.step(110);
  EXPECT_TRUE(other.busy);
}

}  // namespace
}  // namespace triskin::fw
