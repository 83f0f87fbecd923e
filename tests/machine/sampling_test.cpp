// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <map>

#include "bench.hpp"
#include "triskin/board/budget.hpp"
#include "triskin/wire/taxel_frames.hpp"

namespace triskin::machine {
namespace {

constexpr std::uint64_t kSettled_us = 600'000;  // found, checked at both inputs, measured

class Sampling : public Bench {
 protected:
  void start(int modules) {
    store_table(patch(modules));
    power_up();
    run_for(kSettled_us);
    ASSERT_EQ(request({0x10, 0x03}).at(0), 0x50);
    unlock();
    ASSERT_EQ(request({0x2E, 0xFD, 0x05, 0x02}).at(0), 0x6E);  // full stream
    frames.clear();
  }
  void unlock() {
    const auto seed = request({0x27, 0x01});
    ASSERT_EQ(seed.size(), 6U);
    const std::uint32_t s = static_cast<std::uint32_t>(seed[2]) << 24 | static_cast<std::uint32_t>(seed[3]) << 16 | static_cast<std::uint32_t>(seed[4]) << 8 | seed[5];
    const std::uint32_t k = wire::security_key(s);
    ASSERT_EQ(request({0x27, 0x02, static_cast<std::uint8_t>(k >> 24), static_cast<std::uint8_t>(k >> 16), static_cast<std::uint8_t>(k >> 8), static_cast<std::uint8_t>(k)}).at(0), 0x67);
  }
  // Valid samples by module.
  std::map<int, std::vector<wire::FullTaxels>> samples() const {
    std::map<int, std::vector<wire::FullTaxels>> out;
    for (const wire::CanFrame& f : frames) {
      if (const auto t = wire::decode_full(f)) out[t->module].push_back(*t);
    }
    return out;
  }
};

TEST_F(Sampling, SixteenModulesWithoutALostOrRepeatedSample) {
  start(16);
  run_for(2'000'000);
  const auto by_module = samples();
  ASSERT_EQ(by_module.size(), 16U);
  for (const auto& [module, list] : by_module) {
    ASSERT_GE(list.size(), 50U);
    for (std::size_t k = 0; k < list.size(); ++k) {
      EXPECT_EQ(list[k].valid, 0xFFF) << module;
      EXPECT_EQ(list[k].state, static_cast<std::uint8_t>(wire::ModuleState::kOk));
      if (k > 0) {
        EXPECT_EQ(list[k].sample, list[k - 1].sample + 1);
        EXPECT_EQ(list[k].value[0], static_cast<std::uint16_t>(list[k - 1].value[0] + 8)) << "sequence left out or seen twice";
      }
      // Taxels of one chip differ by a fixed step: a torn or mixed-up reading would show.
      for (int t = 1; t < 12; ++t) EXPECT_EQ(static_cast<std::uint16_t>(list[k].value[static_cast<std::size_t>(t)] - list[k].value[0]), t * 0x800);
    }
  }
  expect_no_violation();
}

// 28 bytes of nine bits, start, repeated start and stop (one bit each) at 400 kHz, four modules on each line.
TEST_F(Sampling, FullReadTakesNoMoreThanTheBusLimitAllows) {
  start(16);
  const auto busy_before = machine->counts().i2c_busy_us;
  const std::uint64_t bytes_before = lines[0].bytes;
  constexpr int kCycles = 15;  // between two looks at the configuration there are 16
  run_for(static_cast<std::uint64_t>(kCycles) * TestLine::kSequence_us);
  const double limit_us = 4.0 * (28 * 9 + 3) / 0.4;
  const std::uint64_t bytes = lines[0].bytes - bytes_before;
  for (std::size_t l = 0; l < 4; ++l) {
    const double per_read_us = static_cast<double>(machine->counts().i2c_busy_us[l] - busy_before[l]) / (static_cast<double>(bytes) / (4.0 * 28));
    RecordProperty("line" + std::to_string(l) + "_us", std::to_string(per_read_us));
    EXPECT_LE(per_read_us, 1.05 * limit_us) << "line " << l;
    EXPECT_GE(per_read_us, 0.99 * limit_us) << "line " << l;  // faster than the bus would be an error of the model
  }
}

TEST_F(Sampling, StuckLineDoesNotSlowTheOthersAndComesBack) {
  start(16);
  lines[2].sda_held = true;
  lines[2].frees_after_pulses = 1'000'000;
  run_for(100'000);
  frames.clear();
  run_for(1'000'000);
  auto by_module = samples();
  for (int m = 0; m < 16; ++m) {
    const auto good = std::ranges::count_if(by_module[m], [](const auto& t) { return t.valid == 0xFFF; });
    if (m % 4 == 2) {
      EXPECT_EQ(good, 0) << m;
      EXPECT_EQ(by_module[m].back().state, static_cast<std::uint8_t>(wire::ModuleState::kLineStuck));
    } else {
      EXPECT_GE(good, 26) << m;  // 27.1 sequences in a second: 95 % are 25.7
    }
  }
  EXPECT_GE(lines[2].pulses, 9);
  lines[2].sda_held = false;
  run_for(2'500'000);
  frames.clear();
  run_for(200'000);
  by_module = samples();
  for (int m = 2; m < 16; m += 4) EXPECT_EQ(by_module[m].back().valid, 0xFFF) << m;
  expect_no_violation();
}

TEST_F(Sampling, LineHeldByAChipIsFreedByPulses) {
  start(4);
  lines[1].frees_after_pulses = lines[1].pulses + 5;
  lines[1].sda_held = true;
  run_for(700'000);
  frames.clear();
  run_for(200'000);
  auto by_module = samples();
  EXPECT_EQ(by_module[1].back().valid, 0xFFF);
  EXPECT_GT(lines[1].stops, 0);
}

TEST_F(Sampling, HeldClockIsFoundByTheTimeOut) {
  start(8);
  lines[3].scl_held = true;
  run_for(300'000);
  auto by_module = samples();
  EXPECT_EQ(by_module[3].back().state, static_cast<std::uint8_t>(wire::ModuleState::kLineStuck));
  EXPECT_EQ(by_module[0].back().valid, 0xFFF);
}

TEST_F(Sampling, EachOfSixteenModulesIsNamedWithItsFailure) {
  start(16);
  for (int m = 0; m < 16; ++m) {
    TestLine::Chip& chip = lines[static_cast<std::size_t>(m % 4)].chips[static_cast<std::size_t>(m / 4)];
    for (const auto state : {wire::ModuleState::kAbsent, wire::ModuleState::kWrongId}) {
      if (state == wire::ModuleState::kAbsent) chip.present = false;
      else chip.id = 0x0000;
      chip.regs = {};  // exchanged: the new one has no configuration
      run_for(700'000);
      auto by_module = samples();
      for (int o = 0; o < 16; ++o) {
        EXPECT_EQ(by_module[o].back().state, static_cast<std::uint8_t>(o == m ? state : wire::ModuleState::kOk)) << "module " << m << ", seen at " << o;
      }
      chip.present = true;
      chip.id = 0x1472;
      run_for(700'000);
      frames.clear();
    }
  }
}

TEST_F(Sampling, LostConfigurationIsFoundAndRepaired) {
  start(16);
  lines[1].dip(2);
  bool seen = false;
  for (int k = 0; k < 40; ++k) {
    frames.clear();
    run_for(50'000);
    auto by_module = samples();
    for (const auto& t : by_module[9]) seen = seen || t.state == static_cast<std::uint8_t>(wire::ModuleState::kLostConfiguration);
  }
  EXPECT_TRUE(seen);
  frames.clear();
  run_for(200'000);
  EXPECT_EQ(samples()[9].back().state, static_cast<std::uint8_t>(wire::ModuleState::kOk));
  EXPECT_EQ(lines[1].chips[2].regs[0], 0x00B0);
}

TEST_F(Sampling, StaysInsideItsBudgets) {
  start(16);
  run_for(3'000'000);
  EXPECT_LE(budget(offsetof(board::Budget, worst_interrupt_us)), 25U);  // an I²C byte takes 22.5 µs
  EXPECT_LE(budget(offsetof(board::Budget, worst_loop_us)), 1'000U);
  EXPECT_GE(budget(offsetof(board::Budget, stack_free_bytes)), 2'048U);
  EXPECT_EQ(budget(offsetof(board::Budget, can_lost)), 0U);
  const double idle = static_cast<double>(machine->counts().idle_us) / static_cast<double>(machine->now_us());
  EXPECT_GE(idle, 0.5);
  std::printf("worst interrupt %u us (machine: %.1f us), worst loop %u us, free stack %u bytes, idle %.1f %%\n", budget(offsetof(board::Budget, worst_interrupt_us)),
              static_cast<double>(machine->counts().worst_interrupt) / 1e6, budget(offsetof(board::Budget, worst_loop_us)), budget(offsetof(board::Budget, stack_free_bytes)), 100 * idle);
}

TEST_F(Sampling, TraceShowsTheBytesOfAReading) {
  VcdTrace vcd;
  trace = &vcd;
  start(1);
  const std::string text = vcd.text();
  EXPECT_NE(text.find("$var wire 1 ! scl1 $end"), std::string::npos);
  EXPECT_NE(text.find("$timescale 1 ns $end"), std::string::npos);
  EXPECT_GT(std::ranges::count(text, '#'), 1000);
}

}  // namespace
}  // namespace triskin::machine
