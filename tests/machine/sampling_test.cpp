// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>

#include "sampling_bench.hpp"
#include "triskin/board/budget.hpp"

namespace triskin::machine {
namespace {

using wire::Decimation;

// Oscillators anywhere inside the data sheet's ± 4 %, each module's its own.
constexpr std::array<int, 16> kClock_ppm{-40'000, 40'000,  0,   12'000,  -3'000, 25'000, -31'000, 7'000,
                                         39'000,  -15'000, 500, -39'500, 18'000, -500,   33'000,  -22'000};

// Decimation; part of the spread below; rate that must be reached.
class Whole : public Sampling, public ::testing::WithParamInterface<std::tuple<Decimation, double, double>> {
 protected:
  void spread_clocks(double part) {
    for (int m = 0; m < layout::kMaxModules; ++m) {
      module_at(m).chip->set_clock_error(static_cast<int>(part * kClock_ppm[static_cast<std::size_t>(m)]));
      module_at(m).source.ramp = true;
    }
  }
  // When taxel `t` of module `m` was converted, in steps of the ramp; modulo its length.
  int converted(int m, std::size_t t, const wire::FullTaxels& f) {
    const auto level = static_cast<int>(module_at(m).source.level[t]);
    return (f.value[t] - 0x8000 + level + 16 * PadSource::kRampCounts) % PadSource::kRampCounts;
  }
  static int gap(int later, int earlier) {
    constexpr int kHalf = PadSource::kRampCounts / 2;
    return (later - earlier + kHalf + PadSource::kRampCounts) % PadSource::kRampCounts - kHalf;
  }

  // Every sequence once, all twelve taxels from the same one.
  void expect_whole(int m, const std::vector<wire::FullTaxels>& list) {
    const double stage = static_cast<double>(module_at(m).chip->sequence_us()) / 12.0 / PadSource::kRamp_us;
    constexpr double kNoise = 3.0;  // counts of converter noise, and one of rounding
    for (std::size_t k = 0; k < list.size(); ++k) {
      ASSERT_EQ(list[k].valid, layout::kAllTaxels) << "module " << m;
      for (std::size_t t = 1; t < layout::kTaxelsPerModule; ++t) {
        ASSERT_NEAR(gap(converted(m, t, list[k]), converted(m, 0, list[k])), static_cast<double>(t) * stage, kNoise + 9)
            << "torn: module " << m << " sample " << list[k].sample;
      }
      if (k == 0) continue;
      ASSERT_EQ(list[k].sample, list[k - 1].sample + 1)
          << "lost: module " << m << ", sample " << k << " of " << list.size();
      // A sequence that began anew comes later, never earlier.
      const double passed = gap(converted(m, 0, list[k]), converted(m, 0, list[k - 1]));
      ASSERT_GE(passed, 12 * stage - kNoise - 9) << "repeated: module " << m << " sample " << list[k].sample;
      ASSERT_LE(passed, 24 * stage - kNoise) << "left out: module " << m << " sample " << list[k].sample;
    }
  }
};

TEST_P(Whole, SixteenModulesOnTheirOwnClocksLoseNothing) {
  const auto [decimation, part, rate] = GetParam();
  spread_clocks(part);
  start(16, {decimation, 1});
  run_for(500'000);
  frames.clear();
  constexpr std::uint64_t kRun_us = 3'000'000;
  run_for(kRun_us);
  const auto by_module = samples();
  ASSERT_EQ(by_module.size(), 16U);
  double least = 1.0;
  for (const auto& [m, list] : by_module) {
    expect_whole(m, list);
    const double expected = static_cast<double>(kRun_us) / static_cast<double>(module_at(m).chip->sequence_us());
    least = std::min(least, static_cast<double>(list.size()) / expected);
    EXPECT_GE(static_cast<double>(list.size()), rate * expected - 1) << m;
    EXPECT_LE(static_cast<double>(list.size()), expected + 1) << m;
  }
  std::printf("samples of the slowest module: %.1f %% of its sequences\n", 100 * least);
  if (!on_posix) expect_no_violation();
}

// Chips of one batch, and the widest that the data sheet allows: the ends of those meet again and again, and one
// sequence begins anew then.
INSTANTIATE_TEST_SUITE_P(Decimations, Whole,
                         ::testing::Values(std::tuple{Decimation::k64, 0.05, 0.99},
                                           std::tuple{Decimation::k64, 1.0, 0.98},
                                           std::tuple{Decimation::k128, 1.0, 0.985},
                                           std::tuple{Decimation::k256, 1.0, 0.985}));

TEST_F(Sampling, EachThirdSequenceOnly) {
  start(16, {Decimation::k64, 3});
  run_for(2'000'000);
  for (const auto& [m, list] : samples()) {
    EXPECT_NEAR(static_cast<double>(list.size()), 2'000'000 / 27'600.0, 1.5) << m;
    for (std::size_t k = 1; k < list.size(); ++k) EXPECT_EQ(list[k].sample, list[k - 1].sample + 1) << m;
  }
}

// 28 bytes of nine bits, start, repeated start and stop (one bit each) at 400 kHz, four modules on each line.
TEST_F(Sampling, FullReadTakesNoMoreThanTheBusLimitAllows) {
  start(16, {Decimation::k64, 1});
  for (auto& line : lines) line.bursts.clear();
  run_for(1'000'000);
  const double limit_us = 4.0 * (28 * 9 + 3) / 0.4;
  double worst_us = 0;
  for (std::size_t l = 0; l < layout::kLines; ++l) {
    double sum_us = 0;
    for (const Burst& b : lines[l].bursts) sum_us += static_cast<double>(b.stop_us - b.start_us);
    const double full_us = 4 * sum_us / static_cast<double>(lines[l].bursts.size());
    EXPECT_GE(lines[l].bursts.size(), 4U * 107) << "line " << l;
    EXPECT_GE(full_us, 0.99 * limit_us) << "line " << l;  // faster than the bus would be an error of the model
    worst_us = std::max(worst_us, full_us);
  }
  EXPECT_LE(worst_us, 1.05 * limit_us);
  std::printf("full read of 16 modules: %.0f us of bus time, the limit is %.0f us, ratio %.4f\n", worst_us, limit_us,
              worst_us / limit_us);
}

TEST_F(Sampling, StaysInsideItsBudgetsAtTheShortSequence) {
  start(16, {Decimation::k64, 1});
  run_for(3'000'000);
  EXPECT_LE(budget(offsetof(board::Budget, worst_interrupt_us)), 25U);  // an I²C byte takes 22.5 µs
  EXPECT_LE(budget(offsetof(board::Budget, worst_loop_us)), 400U);      // the window of a burst allows for it
  EXPECT_GE(budget(offsetof(board::Budget, stack_free_bytes)), 2'048U);
  EXPECT_EQ(budget(offsetof(board::Budget, can_lost)), 0U);
  const double idle = static_cast<double>(machine->counts().idle_us) / static_cast<double>(machine->now_us());
  EXPECT_GE(idle, 0.5);
  std::printf(
      "worst interrupt %u us (machine: %.1f us), worst loop %u us, free stack %u bytes, idle %.1f %%\n",
      budget(offsetof(board::Budget, worst_interrupt_us)), static_cast<double>(machine->counts().worst_interrupt) / 1e6,
      budget(offsetof(board::Budget, worst_loop_us)), budget(offsetof(board::Budget, stack_free_bytes)), 100 * idle);
}

TEST_F(Sampling, TraceShowsTheBytesOfAReading) {
  VcdTrace vcd;
  trace = &vcd;
  start(1);
  const std::string file = ::testing::TempDir() + "triskin_reading.vcd";
  vcd.write(file);
  std::printf("lines, CAN and exceptions of the first readings: %s\n", file.c_str());
  const std::string text = vcd.text();
  EXPECT_NE(text.find("$var wire 1 ! scl1 $end"), std::string::npos);
  EXPECT_NE(text.find("$timescale 1 ns $end"), std::string::npos);
  EXPECT_GT(std::ranges::count(text, '#'), 1000);
}

}  // namespace
}  // namespace triskin::machine
