// SPDX-License-Identifier: GPL-3.0-or-later
// Tests the board with the other chip, an STM32L452 (firmware/board/stm32l452): bxCAN, one bank of flash, clocks from
// MSI and HSI, DMA without a multiplexer. I²C lines, tables, loader and crash record are the code of the first chip.
#include <algorithm>
#include <map>
#include <random>
#include <set>

#include "crash_bench.hpp"
#include "failure.hpp"
#include "triskin/board/budget.hpp"
#include "update_bench.hpp"

namespace triskin::machine {
namespace {

class SecondChip : public CrashBench {
 protected:
  void SetUp() override {
    board = nucleo_l452re_board();
    running_slot = 0;
    Bench::SetUp();
  }
  void command(std::uint32_t id, std::initializer_list<std::uint8_t> bytes) {
    wire::CanFrame f;
    f.id = id;
    for (const std::uint8_t b : bytes) f.data.at(f.size++) = b;
    deliver(f);
    run_for(10'000);
  }
  /// Starts the stream as an iCub host does (docs/icub.md): triangles of board 1, a period of 50 ms, no load at 245.
  void start_icub_stream() {
    command(0x201, {0x4D, 0, 50, 245});
    command(0x201, {0x50, 0, 15, 2, 1, 0x00, 0x22});
    run_for(100'000);
    command(0x201, {0x07, 0});
    run_for(500'000);
    frames.clear();
  }
  /// Returns the twelve values of each triangle as the frames of both halves have them, the last of each.
  [[nodiscard]] std::map<unsigned, std::array<int, 12>> triangles() const {
    std::map<unsigned, std::array<int, 12>> out;
    for (const wire::CanFrame& f : frames) {
      if (f.extended || (f.id & 0x7F0) != 0x410) continue;
      std::array<int, 12>& values = out[f.id & 15];
      const bool second = (f.data[0] & 0x80) != 0;
      for (std::size_t k = 0; k < (second ? 5U : 7U); ++k) values[(second ? 7U : 0U) + k] = f.data[k + 1];
    }
    return out;
  }
  /// Returns the longest time between two readings of a module, as its line saw them.
  [[nodiscard]] std::uint64_t worst_gap_us() const {
    std::uint64_t worst = 0;
    for (const SkinLine& line : lines) {
      std::map<int, std::uint64_t> last;
      for (const Burst& b : line.bursts) {
        if (last.contains(b.address)) worst = std::max(worst, b.start_us - last[b.address]);
        last[b.address] = b.start_us;
      }
    }
    return worst;
  }
};

TEST_F(SecondChip, FromTheFactoryFileToTheIcubStream) {
  power_up();
  run_for(400'000);
  const auto hardware = request({0x22, 0xF1, 0x91});
  ASSERT_EQ(hardware.size(), 11U);
  EXPECT_EQ(hardware.back(), '3') << "an image for another board is refused";
  EXPECT_EQ(machine->sysclk_hz(), 80'000'000U);
  EXPECT_EQ(health().value().clock.crystal, wire::Crystal::kUsed);
  EXPECT_EQ(health().value().clock.crystal_mhz, 8U);
  EXPECT_TRUE(confirmed());
  ASSERT_TRUE(flash_table(patch(16)));
  run_for(1'500'000);
  start_icub_stream();
  run_for(500'000);
  const auto before = triangles();
  EXPECT_EQ(before.size(), 16U);
  // More charge on taxel 4 of module 6, the second one of line 3, lowers its value, and no other one.
  module_at(6).source.level[4] += 400;
  frames.clear();
  run_for(1'000'000);
  const auto touched = triangles();
  ASSERT_EQ(touched.size(), 16U);
  constexpr unsigned kTriangle = 4 * 2 + 1;
  for (const auto& [triangle, values] : touched) {
    for (std::size_t t = 0; t < 12; ++t) {
      const int change = values[t] - before.at(triangle)[t];
      if (triangle == kTriangle && t == 4)
        EXPECT_NEAR(change, -400 / 4, 5) << "the stream divides by four";
      else
        EXPECT_NEAR(change, 0, 5) << "triangle " << triangle << " taxel " << t;
    }
  }
  EXPECT_NE(machine->serial_text().find("started: firmware "), std::string::npos) << "the log is on PA2";
  expect_no_violation();
}

TEST_F(SecondChip, FullStreamIsRefusedBecauseItNeedsFdFrames) {
  store_table(patch(4));
  power_up();
  run_for(400'000);
  unlock();
  const auto refused = request({0x2E, 0xFD, 0x05, 0x02});
  ASSERT_GE(refused.size(), 3U);
  EXPECT_EQ(refused[0], 0x7F);
  EXPECT_EQ(refused[2], 0x31) << "request out of range";
  EXPECT_TRUE(std::ranges::none_of(frames, &wire::CanFrame::fd));
  expect_no_violation();
}

TEST_F(SecondChip, RunsFromTheInternalOscillatorWithoutItsCrystal) {
  crystal_hz = 0;
  power_up();
  run_for(400'000);
  const auto state = health();
  ASSERT_TRUE(state.has_value());
  EXPECT_EQ(state->clock.crystal, wire::Crystal::kSilent);
  EXPECT_EQ(state->clock.crystal_mhz, 0U);
  EXPECT_NE(state->findings & board::finding::kNoCrystal, 0U);
  EXPECT_EQ(machine->sysclk_hz(), 80'000'000U);
  expect_no_violation();
}

TEST_F(SecondChip, CrystalThatStopsLeavesItWithTheInternalOscillator) {
  crystal_fails_at_us = 500'000;
  power_up();
  run_for(450'000);
  EXPECT_EQ(health().value().clock.crystal, wire::Crystal::kUsed);
  run_for(500'000);
  const auto state = health();
  ASSERT_TRUE(state.has_value());
  EXPECT_EQ(state->clock.crystal, wire::Crystal::kSilent);
  EXPECT_EQ(crash().value().cause, wire::CrashCause::kClock);
  EXPECT_EQ(machine->counts().resets, 1);
  expect_no_violation();
}

// The one bank stalls whoever reads it, so nothing that runs during an erase may lie there.
TEST_F(SecondChip, ErasesWhileItReadsAndLosesNoSequenceBeyondTheOneUnderWay) {
  watch_reads = true;
  std::vector<FlashOperation> operations;
  flash.log = &operations;
  store_table(patch(16));
  power_up();
  run_for(400'000);
  unlock();
  ASSERT_EQ(request({0x2E, 0xFD, 0x0A, static_cast<std::uint8_t>(wire::Decimation::k64), 1, 0}).at(0), 0x6E);
  run_for(1'000'000);
  start_icub_stream();
  const auto record_and_clear_a_fault = [&](std::uint64_t phase_us) {
    inject(Failure::kSaturated, line_of(5), 5, now_us());
    run_for(200'000);
    repair(Failure::kSaturated, line_of(5), 5);
    run_for(200'000 + phase_us);
    ASSERT_EQ(request({0x14, 0xFF, 0xFF, 0xFF}), std::vector<std::uint8_t>{0x54});
    run_for(50'000);
  };
  record_and_clear_a_fault(0);  // The first page of a new board needs no erase.
  operations.clear();
  for (SkinLine& line : lines) line.bursts.clear();
  const Time stalled_before = machine->counts().flash_stall;
  for (std::uint64_t k = 0; k < 4; ++k) record_and_clear_a_fault(k * 1'700);
  EXPECT_EQ(std::ranges::count(operations, true, &FlashOperation::erase), 4);
  constexpr std::uint64_t kSequence_us = 9'200;
  EXPECT_LE(worst_gap_us(), 2 * kSequence_us);
  EXPECT_EQ(machine->counts().flash_stall, stalled_before) << "code or constants in the flash";
  EXPECT_EQ(machine->counts().flash_read_stalls, 0U);
  EXPECT_EQ(budget(offsetof(board::Budget, can_lost)), 0U);
  std::printf("STM32L452: 4 erases while it reads, longest time between two readings %.1f ms\n",
              static_cast<double>(worst_gap_us()) / 1000);
  expect_no_violation();
}

TEST_F(SecondChip, ReadsOnWhileItsLinesAreDisturbed) {
  constexpr double kPerHour = 18'000;  // Each kind occurs five times a second.
  disturbances = {kPerHour, kPerHour, kPerHour, kPerHour, kPerHour, 1};
  store_table(patch(16));
  power_up();
  run_for(1'500'000);
  start_icub_stream();
  run_for(3'000'000);
  EXPECT_EQ(triangles().size(), 16U);
  const MachineCounts& counts = machine->counts();
  EXPECT_EQ(budget(offsetof(board::Budget, arbitration_losses)), counts.arbitration_losses);
  EXPECT_EQ(budget(offsetof(board::Budget, bus_errors)), counts.spurious_bus_errors);
  EXPECT_GE(counts.arbitration_losses, 8U);
  EXPECT_GE(counts.can_errors, 8U);
  EXPECT_EQ(request({0x19, 0x02, 0xFF}).size(), 3U) << "no fault is recorded";
  expect_no_violation();
}

TEST_F(SecondChip, ComesBackFromBusOff) {
  disturbances.can_errors = 3.6e6;  // One error occurs per millisecond.
  store_table(patch(16));
  power_up();
  run_for(400'000);
  for (int k = 0; k < 20; ++k) (void)request({0x22, 0xFD, 0x10}, 50'000);
  EXPECT_GE(machine->counts().bus_offs, 1U);
  int answered = 0;
  for (int k = 0; k < 20; ++k) answered += request({0x22, 0xF1, 0x90}, 100'000).empty() ? 0 : 1;
  EXPECT_GE(answered, 1);
  expect_no_violation();
}

// What is on the bus for others must not reach the queue; three frames in a row fill the FIFO.
TEST_F(SecondChip, TakesItsOwnFramesAndNoOthers) {
  store_table(patch(1));
  power_up();
  run_for(400'000);
  for (unsigned k = 0; k < 200; ++k) {
    wire::CanFrame other;
    other.extended = k % 2 == 0;
    other.id = other.extended ? 0x1CFFF000 + k : 0x400 + k;
    other.size = 8;
    deliver(other);
    if (k % 3 == 2) run_for(500);
  }
  EXPECT_FALSE(request({0x22, 0xFD, 0x00}).empty());
  for (int k = 0; k < 3; ++k) command(0x7FF, {0});
  EXPECT_EQ(budget(offsetof(board::Budget, can_lost)), 0U);
  expect_no_violation();
}

TEST_F(SecondChip, CrashIsNamedWithItsPlace) {
  store_table(patch(4));
  power_up();
  run_for(400'000);
  overwrite(kUndefined, kUndefined);
  run_for(400'000);
  EXPECT_EQ(machine->counts().resets, 1);
  const auto c = crash();
  ASSERT_TRUE(c.has_value());
  EXPECT_EQ(c->cause, wire::CrashCause::kFault);
  EXPECT_EQ(c->pc & ~1U, address_of(kStep));
}

TEST_F(SecondChip, HangIsNamedWithItsPlace) {
  store_table(patch(4));
  power_up();
  run_for(400'000);
  overwrite(kForEver, kForEver);
  run_for(2'500'000);
  const auto c = crash();
  ASSERT_TRUE(c.has_value());
  EXPECT_EQ(c->cause, wire::CrashCause::kWatchdog);
  EXPECT_EQ(c->pc & ~1U, address_of(kStep));
  expect_no_violation();
}

TEST_F(SecondChip, RandomResetsAndPowerCutsEndInTheApplication) {
  constexpr unsigned kSeed = 452;
  constexpr int kBoards = 40;
  std::mt19937 random(kSeed);
  const FlashChip fresh = flash;
  power_up(true);
  for (int chip = 0; chip < kBoards; ++chip) {
    machine->power_cycle(fresh);
    for (auto k = 1 + random() % 5; k > 0; --k) {
      run_for(random() % 90'000);
      if (random() % 2 == 0) {
        machine->press_reset();
        continue;
      }
      const FlashChip left = flash;
      machine->power_cycle(left);
    }
    run_for(300'000);
    if (machine->vector_table() != kSlotA) run_for(16'000'000);
    ASSERT_EQ(machine->vector_table(), kSlotA) << "board " << chip << " of seed " << kSeed;
  }
}

class SecondChipUpdate : public Update {
 protected:
  void SetUp() override {
    board = nucleo_l452re_board();
    Update::SetUp();
  }
};

TEST_F(SecondChipUpdate, NewApplicationIsWrittenCommittedStartedAndConfirmed) {
  enter_loader();
  ASSERT_EQ(erase(1), 0);
  ASSERT_EQ(write_image(), 0);
  ASSERT_EQ(commit(), 0);
  boot();
  EXPECT_EQ(machine->vector_table(), kSlotB);
  EXPECT_FALSE(request({0x22, 0xFD, 0x00}).empty());
  run_for(10'000);
  EXPECT_TRUE(confirmed());
  expect_no_violation();
}

}  // namespace
}  // namespace triskin::machine
