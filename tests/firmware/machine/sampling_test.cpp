// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>

#include "ramps.hpp"
#include "triskin/board/budget.hpp"

namespace triskin::machine {
namespace {

using wire::Decimation;

// The parameters are decimation; part of the spread below; rate that must be reached; rise time of SCL, ns; behaviour
// of the chips.
class Whole
    : public Ramps,
      public ::testing::WithParamInterface<std::tuple<Decimation, double, double, std::uint32_t, std::string_view>> {};

TEST_P(Whole, SixteenModulesOnTheirOwnClocksLoseNothing) {
  const auto [decimation, part, rate, rise_ns, chip] = GetParam();
  if (!chip.empty()) behave(behaviour_named(chip));
  scl_rise_ns = rise_ns;
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
    // One more may fit because of the ends, and one that was converted before may still have waited for the bus.
    EXPECT_LE(static_cast<double>(list.size()), expected + 2) << m;
  }
  std::printf("samples of the slowest module: %.1f %% of its sequences\n", 100 * least);
  if (!on_posix) expect_no_violation();
}

// The cases have chips of one batch, and the widest spread that the data sheet allows: their ends meet again and again,
// and one sequence is then restarted.
INSTANTIATE_TEST_SUITE_P(Decimations, Whole,
                         ::testing::Values(std::tuple{Decimation::k64, 0.05, 0.99, 0U, ""},
                                           std::tuple{Decimation::k64, 1.0, 0.98, 0U, ""},
                                           std::tuple{Decimation::k128, 1.0, 0.985, 0U, ""},
                                           std::tuple{Decimation::k256, 1.0, 0.985, 0U, ""},
                                           std::tuple{Decimation::k64, 0.05, 0.99, 150U, ""},
                                           std::tuple{Decimation::k64, 0.05, 0.99, 300U, ""},
                                           std::tuple{Decimation::k64, 0.05, 0.99, 300U, "PowerRestarts"},
                                           std::tuple{Decimation::k64, 1.0, 0.98, 0U, "PowerRestarts"},
                                           std::tuple{Decimation::k64, 0.05, 0.99, 300U, "AllAtOnce"},
                                           std::tuple{Decimation::k64, 1.0, 0.98, 0U, "AllAtOnce"},
                                           std::tuple{Decimation::k256, 1.0, 0.985, 0U, "AllAtOnce"}));

// The errors are so many that the controller leaves the bus again and again; it must return and answer.
TEST_F(Sampling, ComesBackFromBusOff) {
  disturbances.can_errors = 3.6e6;  // One error occurs per millisecond.
  store_table(patch(16));
  power_up();
  run_for(300'000);
  for (int k = 0; k < 20; ++k) (void)request({0x22, 0xFD, 0x10}, 50'000);
  EXPECT_GE(machine->counts().bus_offs, 1U);
  int answered = 0;
  for (int k = 0; k < 20; ++k) answered += request({0x22, 0xF1, 0x90}, 100'000).empty() ? 0 : 1;
  EXPECT_GE(answered, 1);
  expect_no_violation();
}

// It pauses for 10, 20, 40 … 1,000 ms, so in five seconds it leaves the bus seven times and then once a second.
TEST_F(Sampling, StaysAwayLongerAfterEachBusOff) {
  start(16);
  const std::uint64_t until_us = now_us() + 5'000'000;
  while (now_us() < until_us) {
    (void)machine->disturb(0, Trouble::kCanError);  // No frame gets through.
    run_for(50);
  }
  EXPECT_GE(machine->counts().bus_offs, 9U);
  EXPECT_LE(machine->counts().bus_offs, 12U);
  std::printf("%d times off the bus in five seconds\n", static_cast<int>(machine->counts().bus_offs));
  run_for(1'100'000);
  EXPECT_FALSE(request({0x22, 0xF1, 0x90}).empty());
  expect_no_violation();
}

// The block then sends nothing until its driver leaves the mode that it has entered by itself.
TEST_F(Sampling, MessageRamThatFailsStopsNoFrames) {
  start(4);
  machine->fail_can_ram();
  frames.clear();
  run_for(500'000);
  EXPECT_EQ(samples().size(), 4U);
  EXPECT_EQ(health().value().can_ram_failures, 1);
  expect_no_violation();
}

TEST_F(Sampling, EachThirdSequenceOnly) {
  start(16, {Decimation::k64, 3});
  run_for(2'000'000);
  for (const auto& [m, list] : samples()) {
    EXPECT_NEAR(static_cast<double>(list.size()), 2'000'000 / 27'600.0, 1.5) << m;
    for (std::size_t k = 1; k < list.size(); ++k) EXPECT_EQ(list[k].sample, list[k - 1].sample + 1) << m;
  }
}

// A reading has 28 bytes of nine bits, start, repeated start and stop (one bit each) at 400 kHz, with four modules on
// each line. The edges have no rise time, or the slowest one of fast mode (UM10204 table 10).
class FullRead : public Sampling, public ::testing::WithParamInterface<std::uint32_t> {};

TEST_P(FullRead, TakesNoMoreThanTheBusLimitAllows) {
  scl_rise_ns = GetParam();
  start(16, {Decimation::k64, 1});
  for (auto& line : lines) line.bursts.clear();
  run_for(1'000'000);
  const double period_us = 2.5 + std::log(1 / 0.3) / std::log(0.7 / 0.3) * scl_rise_ns / 1000;
  const double limit_us = 4.0 * (28 * 9 + 3) * period_us;
  double worst_us = 0;
  for (std::size_t l = 0; l < layout::kLines; ++l) {
    double sum_us = 0;
    for (const Burst& b : lines[l].bursts) sum_us += static_cast<double>(b.stop_us - b.start_us);
    const double full_us = 4 * sum_us / static_cast<double>(lines[l].bursts.size());
    EXPECT_GE(lines[l].bursts.size(), 4U * 107) << "line " << l;
    EXPECT_GE(full_us, 0.99 * limit_us) << "line " << l;  // Faster than the bus would be an error of the model.
    worst_us = std::max(worst_us, full_us);
  }
  EXPECT_LE(worst_us, 1.05 * limit_us);
  std::printf("full read of 16 modules, SCL rises in %u ns: %.0f us of bus time, the limit is %.0f us, ratio %.4f\n",
              scl_rise_ns, worst_us, limit_us, worst_us / limit_us);
  expect_no_violation();
}
INSTANTIATE_TEST_SUITE_P(RiseTimes, FullRead, ::testing::Values(0U, 150U, 300U));

TEST_F(Sampling, StaysInsideItsBudgetsAtTheShortSequence) {
  start(16, {Decimation::k64, 1});
  const std::uint64_t instructions_before = machine->counts().instructions;
  run_for(3'000'000);
  const double per_sequence = static_cast<double>(machine->counts().instructions - instructions_before) * 9.2e-3 / 3;
  EXPECT_LE(budget(offsetof(board::Budget, worst_interrupt_us)), 25U);  // An I²C byte takes 22.5 µs.
  EXPECT_LE(budget(offsetof(board::Budget, worst_loop_us)), 400U);      // The window of a burst allows for this delay.
  EXPECT_GE(budget(offsetof(board::Budget, stack_free_bytes)), 2'048U);
  EXPECT_EQ(budget(offsetof(board::Budget, can_lost)), 0U);
  const double idle = static_cast<double>(machine->counts().idle_us) / static_cast<double>(machine->now_us());
  EXPECT_GE(idle, 0.5);
  const double cycles = 9.2e-3 * static_cast<double>(machine->sysclk_hz());
  EXPECT_LE(per_sequence, 0.5 * cycles);
  std::printf(
      "worst interrupt %u us (machine: %.1f us), worst loop %u us, free stack %u bytes, idle %.1f %%, "
      "%.0f instructions in a sequence of 9.2 ms\n",
      budget(offsetof(board::Budget, worst_interrupt_us)), static_cast<double>(machine->counts().worst_interrupt) / 1e6,
      budget(offsetof(board::Budget, worst_loop_us)), budget(offsetof(board::Budget, stack_free_bytes)), 100 * idle,
      per_sequence);
}

// TRISKIN_IMAGE and TRISKIN_SLOT choose the image, so that two of them can be compared function by function.
TEST_F(Sampling, ProfileTellsWhichFunctionsNeedTheCore) {
  Profile functions;
  profile = &functions;
  start(16, {Decimation::k64, 1});
  functions.clear();
  const std::uint64_t before = machine->counts().instructions, exceptions_before = machine->counts().exceptions;
  constexpr double kRun_s = 3, kSequence_s = 9.2e-3;
  run_for(static_cast<std::uint64_t>(kRun_s * 1e6));
  const std::uint64_t executed = machine->counts().instructions - before;
  std::uint64_t sum = 0;
  for (const Profile::Function& f : functions.by_function(application)) {
    sum += f.instructions;
    const double per_sequence = static_cast<double>(f.instructions) * kSequence_s / kRun_s;
    if (f.instructions >= executed / 200) std::printf("%8.0f  %s\n", per_sequence, f.name.c_str());
  }
  std::printf("%8.0f instructions in a sequence of 9.2 ms, and %.0f exceptions\n",
              static_cast<double>(executed) * kSequence_s / kRun_s,
              static_cast<double>(machine->counts().exceptions - exceptions_before) * kSequence_s / kRun_s);
  EXPECT_EQ(sum, executed);
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
