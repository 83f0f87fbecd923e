// SPDX-License-Identifier: GPL-3.0-or-later
// Compares the constants of the firmware for the STM32L452 and of its modelled machine with facts.txt, whose numbers
// have no common source with them.
#include <gtest/gtest.h>

#include <array>
#include <concepts>
#include <cstdint>
#include <string>
#include <vector>

#include "firmware/silicon/quiet_line.hpp"
#include "triskin/board/board_config.hpp"
#include "triskin/board/clock_plan.hpp"
#include "triskin/board/flash_map.hpp"
#include "triskin/board/i2c_timing.hpp"
#include "triskin/board/registers/bxcan.hpp"
#include "triskin/board/registers/dma.hpp"
#include "triskin/board/registers/i2c.hpp"
#include "triskin/board/registers/spi.hpp"
#include "triskin/board/registers/system.hpp"
#include "triskin/board/registers/usart.hpp"
#include "triskin/board/registers/usb.hpp"
#include "triskin/machine/machine.hpp"
#include "triskin/machine/map_l452.hpp"

namespace triskin {
namespace {

// NOLINTBEGIN(google-build-using-namespace): the rows name constants as facts.txt does
using namespace board;
// NOLINTEND(google-build-using-namespace)

constexpr std::uint64_t value_of(Register r) {
  return r.address();
}
constexpr std::uint64_t value_of(Pin p) {
  return static_cast<std::uint64_t>(p.port - 'A') * 16 + p.number;
}
constexpr std::uint64_t value_of(std::integral auto v) {
  return static_cast<std::uint64_t>(v);
}

struct Row {
  std::string constant;
  std::uint64_t value, fact;
};
struct Reset {
  std::string name;
  std::uint32_t address, fact;
};
#include "facts_table.inc"

TEST(FactsL452, EachConstantOfFirmwareAndMachineIsWhatTheFactSays) {
  ASSERT_GT(kRows.size(), 300U);
  for (const Row& r : kRows) EXPECT_EQ(r.value, r.fact) << r.constant;
}

TEST(FactsL452, TheMachineComesOutOfResetWithTheRegistersOfTheFacts) {
  std::array<QuietLine, 4> lines;
  machine::FlashChip flash;
  flash.store(0x08000000, {0, 0, 0, 0x20, 1, 0, 0, 8});  // The core fetches a stack pointer and an entry.
  machine::MachineSetup setup;
  for (std::size_t k = 0; k < 4; ++k) setup.lines[k] = &lines[k];
  setup.flash = &flash;
  setup.chip = machine::Chip::kStm32l452;
  const machine::Machine machine(setup);
  ASSERT_GT(kResets.size(), 20U);
  for (const Reset& r : kResets) EXPECT_EQ(machine.read_register(r.address), r.fact) << r.name;
  EXPECT_TRUE(machine.violations().empty());
}

// By hand: 160 MHz are twenty times 8 MHz; 16 MHz by two, because an oscillator that is 2 % fast would exceed the
// input; 24 MHz by a third; 20 MHz need a divisor of 2, because 16 MHz is the fastest input; 25 MHz by 5 is the only
// part of it that divides 160 MHz.
TEST(ClockPlanL452, WorkedByHand) {
  EXPECT_EQ(pll_setting(8'000'000), (PllSetting{1, 20}));
  EXPECT_EQ(pll_setting(16'000'000), (PllSetting{2, 20}));
  EXPECT_EQ(pll_setting(24'000'000), (PllSetting{3, 20}));
  EXPECT_EQ(pll_setting(20'000'000), (PllSetting{2, 16}));
  EXPECT_EQ(pll_setting(25'000'000), (PllSetting{5, 32}));
  EXPECT_EQ(pll_setting(3'000'000), std::nullopt) << "below the PLL's input";
  EXPECT_EQ(pll_setting(0), std::nullopt) << "a board without a crystal";
}

TEST(I2cTimingL452, KeepsFastModeAt80Mhz) {
  const auto t = compute_i2c_timing({});
  ASSERT_TRUE(t.has_value());
  EXPECT_GE(t->low_ns, 1300U);
  EXPECT_GE(t->high_ns, 600U);
  EXPECT_GE(t->period_ns, 2500U);
  EXPECT_LE(t->period_ns, 2600U);
}

}  // namespace
}  // namespace triskin
