// SPDX-License-Identifier: GPL-3.0-or-later
// An action that the chip would not forgive must be a violation in the machine, and the right order must not.
#include <gtest/gtest.h>

#include <optional>
#include <string>
#include <vector>

#include "around.hpp"
#include "quiet_line.hpp"
#include "triskin/machine/fdcan.hpp"
#include "triskin/machine/flash_controller.hpp"
#include "triskin/machine/gpio.hpp"
#include "triskin/machine/i2c_controller.hpp"
#include "triskin/machine/nvic.hpp"

namespace triskin::machine {
namespace {

class FlashMisuse : public ::testing::Test {
 protected:
  static constexpr std::uint32_t kAcr = 0x00, kKeyr = 0x08, kOptKeyr = 0x0C, kCr = 0x14, kOptr = 0x20;
  static constexpr std::uint32_t kNoDataCache = 0x00040201, kCaches = 0x00040601, kDataReset = 1U << 12,
                                 kInstructionReset = 1U << 11;
  static constexpr std::uint32_t kErase = 2, kStart = 1U << 16, kBank2 = 1U << 11, kProgram = 1;
  void unlock() {
    flash.write(kKeyr, 0x45670123, 4);
    flash.write(kKeyr, 0xCDEF89AB, 4);
  }
  void erase(std::uint32_t bank) {
    flash.write(kCr, kErase | bank, 4);
    flash.write(kCr, kErase | bank | kStart, 4);
  }
  Around around;
  FlashChip chip;
  Rcc rcc{around, {}};
  FlashController flash{around, chip, rcc, [](std::uint32_t, std::uint32_t) {}};
};

TEST_F(FlashMisuse, TheRightOrderIsNone) {
  flash.write(kAcr, kNoDataCache, 4);
  unlock();
  erase(kBank2);
  EXPECT_TRUE(flash.busy_at(0x08040000));
  EXPECT_FALSE(flash.busy_at(0x0803FFFF));
  around.pass(FlashController::kEraseTime);
  EXPECT_FALSE(flash.busy_at(0x08040000));
  flash.write(kAcr, kNoDataCache | kDataReset, 4);
  flash.write(kAcr, kNoDataCache, 4);
  flash.write(kAcr, kCaches, 4);
  EXPECT_TRUE(around.violations.empty());
}

TEST_F(FlashMisuse, ErasedWithTheDataCacheOn) {
  unlock();
  erase(kBank2);
  around.expect("data cache on");
}

TEST_F(FlashMisuse, ProgrammedWithTheDataCacheOn) {
  unlock();
  flash.write(kCr, kProgram, 4);
  flash.cell_write(0x08040000, 1, 4);
  flash.cell_write(0x08040004, 2, 4);
  around.expect("data cache on");
}

TEST_F(FlashMisuse, DataCacheOnAgainWithWhatItHeldBeforeAnErase) {
  flash.write(kAcr, kNoDataCache, 4);
  unlock();
  erase(0);
  around.pass(FlashController::kEraseTime);
  flash.write(kAcr, kCaches, 4);
  around.expect("before an erase");
}

TEST_F(FlashMisuse, CachesResetWhileTheyAreOn) {
  flash.write(kAcr, kCaches | kDataReset, 4);
  around.expect("DCRST");
  around.violations.clear();
  flash.write(kAcr, kCaches | kInstructionReset, 4);
  around.expect("ICRST");
}

TEST_F(FlashMisuse, DebuggerShutOut) {
  flash.write(kAcr, 0x704, 4);
  around.expect("debugger");
}

TEST_F(FlashMisuse, EraseOfAChipWithOneBank) {
  chip.options &= ~(1U << 22);
  flash.load_options();
  flash.write(kAcr, kNoDataCache, 4);
  unlock();
  erase(0);
  around.expect("DBANK");
  EXPECT_TRUE(flash.busy_at(0x08000000));
  EXPECT_TRUE(flash.busy_at(0x08040000));
}

TEST_F(FlashMisuse, OptionsWrittenWithoutTheirKeys) {
  unlock();
  flash.write(kOptr, 0, 4);
  around.expect("FLASH_OPTR");
  around.violations.clear();
  flash.write(kCr, 1U << 17, 4);
  around.expect("OPTSTRT");
  around.violations.clear();
  flash.write(kOptKeyr, 0x12345678, 4);
  around.expect("FLASH_OPTKEYR");
}

TEST_F(FlashMisuse, OptionsCountWhenTheyAreWritten) {
  flash.write(kAcr, kNoDataCache, 4);
  unlock();
  flash.write(kOptKeyr, 0x08192A3B, 4);
  flash.write(kOptKeyr, 0x4C5D6E7F, 4);
  flash.write(kOptr, 0xFBEFF8AA, 4);
  flash.write(kCr, 1U << 17, 4);
  EXPECT_EQ(chip.options, 0xFFEFF8AAU);
  around.pass(FlashController::kEraseTime);
  EXPECT_EQ(chip.options, 0xFBEFF8AAU);
  EXPECT_TRUE(around.violations.empty());
}

// RM0440 §3.4.2: a system reset does not load what was written, OBL_LAUNCH does.
TEST_F(FlashMisuse, OptionsAreUsedWhenTheyAreLoaded) {
  chip.options = 0xFBEFF8AA;
  flash.reset();
  EXPECT_EQ(flash.loaded_options(), 0xFFEFF8AAU);
  EXPECT_EQ(flash.read(kOptr, 4), 0xFFEFF8AAU);
  unlock();
  flash.write(kCr, 1U << 27, 4);
  around.expect("OBL_LAUNCH while options are locked");
  flash.write(kOptKeyr, 0x08192A3B, 4);
  flash.write(kOptKeyr, 0x4C5D6E7F, 4);
  flash.write(kCr, 1U << 27, 4);
  flash.reset();
  EXPECT_EQ(flash.loaded_options(), 0xFBEFF8AAU);
}

// The loader has pages 0 … 7 of bank 1; the page behind them and bank 2 can be written as before.
TEST_F(FlashMisuse, WriteProtectedPagesStay) {
  chip.write_protection = 7U << 16;
  flash.load_options();
  flash.reset();
  flash.write(kAcr, kNoDataCache, 4);
  for (const std::uint32_t page : {0U, 7U}) {
    around.violations.clear();
    unlock();
    flash.write(kCr, kErase | page << 3, 4);
    flash.write(kCr, kErase | page << 3 | kStart, 4);
    around.expect("write-protected");
    EXPECT_EQ(flash.read(0x10, 4) & 0x10, 0x10U) << "WRPERR";
    flash.write(kCr, 1U << 31, 4);
    flash.write(0x10, 0x10, 4);
  }
  around.violations.clear();
  unlock();
  flash.write(kCr, kErase | 8 << 3, 4);
  flash.write(kCr, kErase | 8 << 3 | kStart, 4);
  EXPECT_TRUE(around.violations.empty());
  around.pass(FlashController::kEraseTime);
  flash.write(kCr, kProgram, 4);
  flash.cell_write(0x08000000, 1, 4);
  flash.cell_write(0x08000004, 1, 4);
  around.expect("write-protected");
}

TEST(Misuse, VectorsThatAreNotAligned) {
  Around around;
  Nvic nvic(around);
  nvic.write(0xD08, 0x08004100, 4);
  around.expect("VTOR");
}

// A PLL never becomes ready at a frequency that its oscillator cannot give, and the request is a violation: 24 MHz by 2
// times 85 is 1,020 MHz.
class PllMisuse : public ::testing::Test {
 protected:
  static constexpr std::uint32_t kCr = 0x00, kPll = 0x0C, kHse = 1U << 16, kPllOn = 1U << 24, kPllReady = 1U << 25;
  void start_pll(std::uint64_t crystal_hz, std::uint32_t divider, std::uint32_t factor) {
    rcc.emplace(around, CrystalSetup{.hz = crystal_hz});
    rcc->write(kCr, 0x500 | kHse, 4);
    around.pass(10'000 * kMicrosecond);
    rcc->write(kPll, 3 | (divider - 1) << 4 | factor << 8 | 1U << 24, 4);
    rcc->write(kCr, 0x500 | kHse | kPllOn, 4);
    around.pass(10'000 * kMicrosecond);
  }
  [[nodiscard]] bool ready() { return (rcc->read(kCr, 4) & kPllReady) != 0; }
  Around around;
  std::optional<Rcc> rcc;
};

TEST_F(PllMisuse, TheRightSettingIsNone) {
  start_pll(24'000'000, 3, 40);
  EXPECT_TRUE(ready());
  EXPECT_TRUE(around.violations.empty());
}

TEST_F(PllMisuse, OscillatorOutsideItsLimits) {
  start_pll(24'000'000, 2, 85);
  EXPECT_FALSE(ready());
  around.expect("1020000000 Hz");
}

TEST_F(PllMisuse, InputOutsideItsLimits) {
  start_pll(25'000'000, 10, 127);
  EXPECT_FALSE(ready());
  around.expect("input of 2500000 Hz");
}

TEST_F(PllMisuse, NoCrystal) {
  start_pll(0, 1, 40);
  EXPECT_FALSE(ready());
  around.expect("without a clock");
}

TEST(Misuse, DelayCompensationWithALargeDataPrescaler) {
  Around around;
  bool pins = true;
  Fdcan can(around, [](const wire::CanFrame&, std::uint64_t) {}, nullptr, [&] { return pins; });
  constexpr std::uint32_t kCccr = 0x18, kDbtp = 0x0C, kDelay = 1U << 23;
  const auto start_with = [&](std::uint32_t data) {
    can.write(kCccr, 3, 4);
    can.write(kDbtp, data, 4);
    can.write(kCccr, 0, 4);
  };
  start_with(kDelay | 1U << 16 | 0xA33);  // A prescaler of 2 is allowed.
  start_with(4U << 16 | 0xA33);           // Any prescaler is allowed without compensation.
  EXPECT_TRUE(around.violations.empty());
  start_with(kDelay | 4U << 16 | 0xA33);
  around.expect("prescaler of 5");
  around.violations.clear();
  pins = false;
  start_with(0xA33);
  around.expect("PB8");
}

// Lines 1 and 2 need function 4, lines 3 and 4 need function 8; all are open drain.
TEST(Misuse, LineStartedWhileItsPinsAreSomethingElse) {
  Around around;
  Rcc rcc(around, {});
  rcc.write(0x4C, 7, 4);
  std::array<QuietLine, 4> buses;
  RouteChainPins chain(nullptr);
  Gpio gpio(around, rcc, {&buses[0], &buses[1], &buses[2], &buses[3]}, chain);
  Dma dma(around, [](std::uint32_t) -> std::uint8_t* { return nullptr; });
  I2cController line(around, 2, buses[2], 92, 93, dma, nullptr, [&] { return gpio.line_ready(2); });
  constexpr std::uint32_t kPortC = 0x800, kTiming = 0x10305F7F;  // The timing is slow enough.
  const auto start = [&] {
    line.write(0x00, 0, 4);
    line.write(0x10, kTiming, 4);
    line.write(0x00, 1, 4);
    line.write(0x04, 0x2C << 1 | 1U << 13 | 1U << 16, 4);
  };
  start();
  around.expect("I2C3");
  around.violations.clear();
  gpio.write(kPortC + 0x04, 0x300, 4);       // The pins are open drain.
  gpio.write(kPortC + 0x24, 0x88, 4);        // The pins have function 8.
  gpio.write(kPortC + 0x00, 0xFFFAFFFF, 4);  // The pins are in alternate mode.
  start();
  EXPECT_TRUE(around.violations.empty());
  gpio.write(kPortC + 0x24, 0x84, 4);  // SCL has the function of line 1.
  start();
  around.expect("I2C3");
}

// Simulates a line on which a chip acknowledges everything.
class WillingLine final : public QuietLine {
 public:
  bool start(std::uint8_t, std::uint64_t) override { return true; }
  bool write(std::uint8_t, std::uint64_t) override { return true; }
};

// Between the written bytes and the repeated start the controller holds SCL low, so nobody can be taken for another
// master. With a loss there, firmware that follows the manual would be blamed for its repeated start.
TEST(Misuse, ArbitrationCannotBeLostWhileTheControllerHoldsSclItself) {
  Around around;
  WillingLine bus;
  Dma dma(around, [](std::uint32_t) -> std::uint8_t* { return nullptr; });
  I2cController line(around, 0, bus, 31, 32, dma, nullptr, [] { return true; });
  constexpr std::uint32_t kTxIs = 2, kComplete = 1U << 6, kLost = 1U << 9, kStart = 1U << 13;
  line.write(0x10, 0x10305F7F, 4);
  line.write(0x00, 1, 4);
  EXPECT_FALSE(line.lose_arbitration()) << "idle";
  line.write(0x04, 0x2C << 1 | kStart | 1U << 16, 4);  // The transfer has one byte and no automatic end.
  around.pass(kSecond);
  ASSERT_EQ(line.read(0x18, 4) & kTxIs, kTxIs);
  EXPECT_FALSE(line.lose_arbitration()) << "waits for the byte to send";
  line.write(0x28, 0x0B, 4);
  around.pass(kSecond);
  ASSERT_EQ(line.read(0x18, 4) & kComplete, kComplete);
  EXPECT_FALSE(line.lose_arbitration()) << "waits for the repeated start";
  line.write(0x04, 0x2C << 1 | kStart | 1U << 10 | 1U << 16, 4);
  EXPECT_TRUE(line.lose_arbitration());
  EXPECT_EQ(line.read(0x18, 4) & kLost, kLost);
  EXPECT_TRUE(around.violations.empty());
  line.write(0x04, 0x2C << 1 | kStart | 1U << 16, 4);
  around.expect("before the bus was cleared");
}

}  // namespace
}  // namespace triskin::machine
