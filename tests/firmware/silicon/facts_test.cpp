// SPDX-License-Identifier: GPL-3.0-or-later
// Compares the constants of the firmware and of the modelled machine, and the reset values of the machine, with
// tests/firmware/silicon/facts.txt, whose numbers have no common source with them.
#include <gtest/gtest.h>

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "quiet_line.hpp"
#include "triskin/board/board_config.hpp"
#include "triskin/board/flash_map.hpp"
#include "triskin/board/i2c_timing.hpp"
#include "triskin/board/registers/dma.hpp"
#include "triskin/board/registers/fdcan.hpp"
#include "triskin/board/registers/i2c.hpp"
#include "triskin/board/registers/spi.hpp"
#include "triskin/board/registers/system.hpp"
#include "triskin/board/registers/timer16.hpp"
#include "triskin/board/registers/usart.hpp"
#include "triskin/board/registers/usb.hpp"
#include "triskin/drivers/ad7147.hpp"
#include "triskin/machine/machine.hpp"
#include "triskin/machine/map.hpp"

namespace triskin {
namespace {

// NOLINTBEGIN(google-build-using-namespace): the rows name constants as facts.txt does
using namespace board;
using namespace fw;
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

TEST(Facts, EachConstantOfFirmwareAndMachineIsWhatTheFactSays) {
  ASSERT_GT(kRows.size(), 300U);
  for (const Row& r : kRows) EXPECT_EQ(r.value, r.fact) << r.constant;
}

TEST(Facts, TheMachineComesOutOfResetWithTheRegistersOfTheFacts) {
  std::array<QuietLine, 4> lines;
  machine::FlashChip flash;
  flash.store(0x08000000, {0, 0, 0, 0x20, 1, 0, 0, 8});  // The core fetches a stack pointer and an entry.
  machine::MachineSetup setup;
  for (std::size_t k = 0; k < 4; ++k) setup.lines[k] = &lines[k];
  setup.flash = &flash;
  const machine::Machine machine(setup);
  ASSERT_GT(kResets.size(), 40U);
  for (const Reset& r : kResets) EXPECT_EQ(machine.read_register(r.address), r.fact) << r.name;
  EXPECT_TRUE(machine.violations().empty());
}

}  // namespace
}  // namespace triskin
