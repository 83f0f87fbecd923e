// SPDX-License-Identifier: GPL-3.0-or-later
// An action that the STM32L452 would not forgive must be a violation in the machine, and the right order must not.
#include <gtest/gtest.h>

#include "firmware/silicon/around.hpp"
#include "triskin/machine/bxcan.hpp"
#include "triskin/machine/dma.hpp"
#include "triskin/machine/flash_controller.hpp"
#include "triskin/machine/system_blocks.hpp"

namespace triskin::machine {
namespace {

class BxcanRules : public ::testing::Test {
 protected:
  static constexpr std::uint32_t kMcr = 0x00, kMsr = 0x04, kTsr = 0x08, kRf0r = 0x0C, kIer = 0x14, kEsr = 0x18,
                                 kBtr = 0x1C, kMailbox = 0x180, kFifo = 0x1B0, kFmr = 0x200, kFs1r = 0x20C,
                                 kFa1r = 0x21C, kBank = 0x240;
  static constexpr std::uint32_t kTiming = 3U << 24 | 3U << 20 | 14U << 16 | 3;  // 20 quanta of 50 ns at 80 MHz.
  void write(std::uint32_t offset, std::uint32_t value) { can.write(offset, value, 4); }
  std::uint32_t read(std::uint32_t offset) { return can.read(offset, 4); }
  /// Lets extended identifiers 0x100 … 0x1FF pass.
  void start() {
    write(kMcr, 1 | 4);
    write(kBtr, kTiming);
    write(kFmr, 1);
    write(kFs1r, 1);
    write(kBank, 0x100U << 3 | 4);
    write(kBank + 4, 0x1FFFFF00U << 3 | 4 | 2);
    write(kFa1r, 1);
    write(kFmr, 0);
    write(kMcr, 4);
    around.pass(20 * kMicrosecond);
  }
  void send(std::uint32_t mailbox, std::uint32_t id) {
    write(kMailbox + 16 * mailbox + 4, 8);
    write(kMailbox + 16 * mailbox, id << 3 | 4 | 1);
  }
  /// Passes time in small steps, because a frame begins when the one before has ended.
  void pass(Time by) {
    constexpr Time kStep = 5 * kMicrosecond;
    for (Time gone = 0; gone < by; gone += kStep) around.pass(kStep);
  }
  static wire::CanFrame frame(std::uint32_t id, bool fd = false) {
    wire::CanFrame f;
    f.extended = true;
    f.id = id;
    f.size = 3;
    f.data = {1, 2, 3};
    f.fd = fd;
    return f;
  }
  Around around{80'000'000};
  std::vector<wire::CanFrame> sent;
  bool ready = true;
  Bxcan can{around, [this](const wire::CanFrame& f, std::uint64_t) { sent.push_back(f); }, nullptr,
            [this] { return ready; }};
};

TEST_F(BxcanRules, TheRightOrderIsNone) {
  EXPECT_EQ(read(kMsr) & 3, 2U) << "it sleeps after a reset";
  start();
  EXPECT_EQ(read(kMsr) & 3, 0U);
  can.from_bus(frame(0x123));
  can.from_bus(frame(0x223));
  pass(1'000 * kMicrosecond);
  EXPECT_EQ(read(kRf0r) & 3, 1U) << "one identifier passes, the other does not";
  EXPECT_EQ(read(kFifo), 0x123U << 3 | 4);
  EXPECT_EQ(read(kFifo + 4) & 15, 3U);
  EXPECT_EQ(read(kFifo + 8), 0x030201U);
  write(kRf0r, 32);
  EXPECT_EQ(read(kRf0r) & 3, 0U);
  EXPECT_TRUE(around.violations.empty());
}

TEST_F(BxcanRules, FramesAreSentInTheOrderOfTheirRequests) {
  start();
  for (std::uint32_t k = 0; k < 3; ++k) {
    EXPECT_EQ(read(kTsr) >> 24 & 3, k) << "the next free mailbox";
    send(k, 0x300 - k);
  }
  EXPECT_EQ(read(kTsr) >> 26 & 7, 0U) << "none is free";
  pass(2'000 * kMicrosecond);
  ASSERT_EQ(sent.size(), 3U);
  EXPECT_EQ(sent[0].id, 0x300U);
  EXPECT_EQ(sent[2].id, 0x2FEU);
  EXPECT_EQ(read(kTsr) & 0x010101, 0x010101U) << "completed";
  write(kTsr, 0x010101);
  EXPECT_EQ(read(kTsr) & 0x010101, 0U);
  EXPECT_TRUE(around.violations.empty());
}

TEST_F(BxcanRules, FourthFrameInARowOverwritesTheThird) {
  start();
  for (std::uint32_t k = 0; k < 4; ++k) can.from_bus(frame(0x100 + k));
  pass(2'000 * kMicrosecond);
  EXPECT_EQ(read(kRf0r) & 0x1B, 3U | 8U | 16U) << "three, full, overrun";
  write(kRf0r, 32);
  write(kRf0r, 32);
  EXPECT_EQ(read(kFifo) >> 3, 0x103U);
}

TEST_F(BxcanRules, BitTimingOutsideInitialization) {
  start();
  write(kBtr, kTiming);
  around.expect("BTR written outside initialization");
}

TEST_F(BxcanRules, BitThatIsNoMicrosecond) {
  write(kMcr, 1);
  write(kBtr, kTiming + 1);
  write(kMcr, 0);
  around.expect("on a bus of 1 Mbit/s");
}

TEST_F(BxcanRules, StartWithoutPins) {
  ready = false;
  write(kMcr, 1);
  write(kBtr, kTiming);
  write(kMcr, 0);
  around.expect("a pin is not its alternate function");
}

TEST_F(BxcanRules, MailboxWhileItsTransmissionIsPending) {
  start();
  send(0, 0x300);
  write(kMailbox + 8, 1);
  around.expect("mailbox written while its transmission is pending");
}

TEST_F(BxcanRules, FilterWithoutItsInitialization) {
  start();
  write(kFs1r, 3);
  around.expect("written without FINIT");
}

TEST_F(BxcanRules, FilterWhileItIsActive) {
  start();
  write(kBank, 0);
  around.expect("written while it is active");
}

TEST_F(BxcanRules, EmptyFifo) {
  start();
  (void)read(kFifo);
  around.expect("FIFO 0 read while empty");
}

TEST_F(BxcanRules, FdFrameOnAClassicBus) {
  start();
  can.from_bus(frame(0x123, true));
  pass(1'000 * kMicrosecond);
  around.expect("FD frame");
}

// ISO 11898-1: 32 errors in a row while it sends lead to bus-off. The block returns by a visit to initialization, after
// eleven recessive bits 129 times, and then sends what waited.
TEST_F(BxcanRules, BusOffEndsByAVisitToInitialization) {
  start();
  write(kIer, 1U << 10 | 1U << 15);
  send(0, 0x300);
  for (int k = 0; k < 32; ++k) {
    pass(30 * kMicrosecond);
    ASSERT_TRUE(can.spoil_frame()) << k;
  }
  EXPECT_EQ(read(kEsr) & 7, 7U) << "warning, passive, off";
  EXPECT_EQ(read(kMsr) & 4, 4U);
  pass(50'000 * kMicrosecond);
  EXPECT_TRUE(sent.empty()) << "it does not return by itself";
  write(kMcr, 1 | 4);
  EXPECT_EQ(read(kMsr) & 1, 1U);
  write(kMcr, 4);
  pass(1'000 * kMicrosecond);
  EXPECT_TRUE(sent.empty());
  pass(1'000 * kMicrosecond);
  EXPECT_EQ(sent.size(), 1U);
  EXPECT_EQ(read(kEsr) & 7, 0U);
  EXPECT_TRUE(around.violations.empty());
}

class ClockRules : public ::testing::Test {
 protected:
  static constexpr std::uint32_t kCr = 0x00, kCfgr = 0x08, kPllCfgr = 0x0C, kPllOn = 1U << 24, kOutput = 1U << 24;
  void start_pll(std::uint32_t setting) {
    rcc.write(kCr, 0x63 | 1U << 8, 4);
    around.pass(10 * kMicrosecond);
    rcc.write(kPllCfgr, setting, 4);
    rcc.write(kCr, 0x163 | kPllOn, 4);
    around.pass(100 * kMicrosecond);
  }
  Around around;
  RccL4 rcc{around, {}};
};

TEST_F(ClockRules, TheRightOrderIsNone) {
  EXPECT_EQ(rcc.sysclk_hz(), 4'000'000U);
  start_pll(2 | 10U << 8 | kOutput);
  rcc.set_wait_states(4);
  rcc.write(kCfgr, 3, 4);
  EXPECT_EQ(rcc.sysclk_hz(), 80'000'000U);
  EXPECT_TRUE(around.violations.empty());
}

TEST_F(ClockRules, PllWithoutItsSource) {
  rcc.write(kPllCfgr, 2 | 10U << 8 | kOutput, 4);
  rcc.write(kCr, 0x63 | kPllOn, 4);
  around.expect("without a clock at its input");
}

TEST_F(ClockRules, PllInputBelow4Mhz) {
  start_pll(2 | 7U << 4 | 80U << 8 | kOutput);
  around.expect("PLL input of 2000000 Hz");
}

TEST_F(ClockRules, PllOscillatorAbove344Mhz) {
  start_pll(2 | 22U << 8 | kOutput);
  around.expect("PLL oscillator at 352000000 Hz");
}

TEST_F(ClockRules, TooFewWaitStates) {
  start_pll(2 | 10U << 8 | kOutput);
  rcc.set_wait_states(3);
  rcc.write(kCfgr, 3, 4);
  around.expect("3 flash wait states at 80000000 Hz");
}

TEST_F(ClockRules, ClockThatIsNotReady) {
  rcc.write(kCfgr, 1, 4);
  around.expect("names a clock that is not ready");
}

class FlashRules : public ::testing::Test {
 protected:
  void erase(std::uint32_t control) {
    flash.write(0x00, 0x204, 4);
    flash.write(0x08, 0x45670123, 4);
    flash.write(0x08, 0xCDEF89AB, 4);
    flash.write(0x14, 2 | control, 4);
    flash.write(0x14, 2 | control | 1U << 16, 4);
  }
  Around around;
  FlashChip chip;
  RccL4 rcc{around, {}};
  FlashController flash{around, chip, rcc, [](std::uint32_t, std::uint32_t) {}, true};
};

// Page 200 lies in the second half, which is a bank of its own in the other chip.
TEST_F(FlashRules, OneBankIsBusyAsAWhole) {
  chip.bytes[200 * 2048] = 0;
  erase(200U << 3);
  EXPECT_TRUE(flash.busy_at(0x08000000));
  EXPECT_TRUE(flash.busy_at(0x0807FFFF));
  around.pass(FlashController::kEraseTime);
  EXPECT_EQ(chip.bytes[200 * 2048], 0xFF);
  EXPECT_TRUE(around.violations.empty());
}

TEST_F(FlashRules, BankBitOfTheOtherChip) {
  erase(1U << 11);
  around.expect("one bank");
}

TEST(DmaL452, SelectionConnectsARequestToItsChannelOnly) {
  Around around;
  std::array<std::uint8_t, 4> memory{1, 2, 3, 4};
  SelectingDma dma(around, [&](std::uint32_t at) { return &memory.at(at); }, 1);
  dma.reset();
  constexpr std::uint32_t kChannel6 = 0x08 + 5 * 20, kSelection = 0xA8, kI2c1Send = 17;
  dma.write(kChannel6 + 4, 4, 4);
  dma.write(kChannel6, 1 | 1U << 4 | 1U << 7, 4);
  EXPECT_FALSE(dma.fetch(kI2c1Send).has_value()) << "not selected yet";
  dma.write(kSelection, 3U << 20, 4);
  EXPECT_EQ(around.violations.size(), 1U) << "the channel was on";
  EXPECT_EQ(dma.fetch(kI2c1Send), 1);
  EXPECT_FALSE(dma.fetch(19).has_value()) << "I2C2 is at channel 4";
  dma.write(0x94, 1, 4);
  EXPECT_EQ(around.violations.size(), 2U) << "there is no channel 8";
}

}  // namespace
}  // namespace triskin::machine
