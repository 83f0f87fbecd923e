// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "triskin/board/registers/register.hpp"

namespace triskin::board {

/// Embedded flash, RM0440 §3.7 (category 3 device).
namespace flash_reg {
inline constexpr std::uint32_t kBase = 0x40022000;
inline constexpr Register kAcr{kBase + 0x00}, kKeyr{kBase + 0x08}, kSr{kBase + 0x10}, kCr{kBase + 0x14},
    kEccr{kBase + 0x18};
inline constexpr std::uint32_t kKey1 = 0x45670123, kKey2 = 0xCDEF89AB;  // §3.3.5
inline constexpr std::uint32_t kLatency4 = 4, kPrefetch = bit(8), kInstructionCache = bit(9), kDataCache = bit(10);
inline constexpr std::uint32_t kEndOfOperation = bit(0), kBusy = bit(16);
inline constexpr std::uint32_t kErrors = bit(1) | bit(3) | bit(4) | bit(5) | bit(6) | bit(7) | bit(8) | bit(9);
inline constexpr std::uint32_t kProgram = bit(0), kPageErase = bit(1), kPageShift = 3, kBank2 = bit(11),
                               kStart = bit(16), kLock = bit(31);
inline constexpr std::uint32_t kEccDetected = bit(31);  // two bits wrong: NMI
}  // namespace flash_reg

/// Power control, §6.4.
namespace pwr_reg {
inline constexpr std::uint32_t kBase = 0x40007000;
inline constexpr Register kCr1{kBase + 0x00}, kCr5{kBase + 0x80};
inline constexpr std::uint32_t kNoBoost = bit(8);  // R1MODE = 0 above 150 MHz (§6.1.5)
}  // namespace pwr_reg

/// Reset and clock control, §7.4.
namespace rcc_reg {
inline constexpr std::uint32_t kBase = 0x40021000;
inline constexpr Register kCr{kBase + 0x00}, kCfgr{kBase + 0x08}, kPllCfgr{kBase + 0x0C}, kAhb1Enr{kBase + 0x48},
    kAhb2Enr{kBase + 0x4C}, kApb1Enr1{kBase + 0x58}, kApb1Enr2{kBase + 0x5C}, kApb2Enr{kBase + 0x60},
    kCcipr{kBase + 0x88}, kCsr{kBase + 0x94}, kCrrcr{kBase + 0x98}, kCcipr2{kBase + 0x9C};
inline constexpr std::uint32_t kHseOn = bit(16), kHseReady = bit(17), kPllOn = bit(24), kPllReady = bit(25);
inline constexpr std::uint32_t kSwitchMask = 3, kSwitchHsi = 1, kSwitchHse = 2, kSwitchPll = 3, kStatusShift = 2,
                               kAhbMask = 0xF0, kAhbHalf = 0x80;
inline constexpr std::uint32_t kPllFromHse = 3, kPllFromHsi = 2, kPllREnable = bit(24);
inline constexpr std::uint32_t kDma1 = bit(0), kDmaMux = bit(2), kFlashClock = bit(8), kGpioA = bit(0), kGpioB = bit(1),
                               kGpioC = bit(2);
inline constexpr std::uint32_t kTim2 = bit(0), kCrs = bit(8), kSpi2 = bit(14), kI2c1 = bit(21), kI2c2 = bit(22),
                               kUsb = bit(23), kFdcan = bit(25), kPwr = bit(28), kI2c3 = bit(30);  // APB1ENR1
inline constexpr std::uint32_t kI2c4 = bit(1);                                                     // APB1ENR2
inline constexpr std::uint32_t kFdcanFromPclk1 = 2U << 24;                                         // CCIPR.FDCANSEL
inline constexpr std::uint32_t kHsi48On = bit(0), kHsi48Ready = bit(1);
inline constexpr std::uint32_t kRemoveResetFlags = bit(23), kWatchdogReset = bit(29);
}  // namespace rcc_reg

/// General-purpose timer with 32 bits, §29.4 (TIM2).
namespace tim2_reg {
inline constexpr std::uint32_t kBase = 0x40000000;
inline constexpr Register kCr1{kBase + 0x00}, kDier{kBase + 0x0C}, kSr{kBase + 0x10}, kEgr{kBase + 0x14},
    kCnt{kBase + 0x24}, kPsc{kBase + 0x28}, kArr{kBase + 0x2C}, kCcr1{kBase + 0x34};
inline constexpr std::uint32_t kEnable = bit(0), kCompare1 = bit(1), kUpdate = bit(0);
inline constexpr int kIrq = 28;
}  // namespace tim2_reg

/// Independent watchdog, §42.4. Runs from the 32 kHz oscillator and cannot be stopped.
namespace iwdg_reg {
inline constexpr std::uint32_t kBase = 0x40003000;
inline constexpr Register kKr{kBase + 0x00}, kPr{kBase + 0x04}, kRlr{kBase + 0x08}, kSr{kBase + 0x0C};
inline constexpr std::uint32_t kStart = 0xCCCC, kUnlock = 0x5555, kReload = 0xAAAA;
}  // namespace iwdg_reg

/// Unique device id, §48.1: 96 bits.
inline constexpr std::uint32_t kUniqueIdAddress = 0x1FFF7590;

/// Cortex-M4 system control space (ARMv7-M architecture reference manual, B3.2 … B3.4).
namespace core_reg {
inline constexpr Register kSysTickCsr{0xE000E010}, kSysTickRvr{0xE000E014}, kSysTickCvr{0xE000E018}, kIcsr{0xE000ED04},
    kVtor{0xE000ED08}, kAircr{0xE000ED0C}, kCpacr{0xE000ED88}, kCfsr{0xE000ED28}, kHfsr{0xE000ED2C};
inline constexpr std::uint32_t kResetRequest = 0x05FA0004, kFpuFull = 0xFU << 20;
/// Lets interrupt `irq` (0..101, RM0440 table 97) through the NVIC.
inline void enable_interrupt(int irq) {
  Register(0xE000E100U + 4U * static_cast<unsigned>(irq / 32)).write(bit(static_cast<unsigned>(irq % 32)));
}
/// Priority of an interrupt: the upper four bits count, 0 is the most urgent.
inline void set_priority(int irq, std::uint8_t priority) {
  *reinterpret_cast<volatile std::uint8_t*>(0xE000E400U + static_cast<unsigned>(irq)) = priority;
}
/// Switches off every interrupt and gives the peripherals of APB1 their reset values (RCC_APB1RSTR1, §7.4.14).
inline void reset_peripherals() {
  for (std::uint32_t k = 0; k < 4; ++k) Register(0xE000E180U + 4 * k).write(0xFFFFFFFF);
  for (std::uint32_t k = 0; k < 4; ++k) Register(0xE000E280U + 4 * k).write(0xFFFFFFFF);
  const Register reset_register{0x40021038};
  reset_register.write(bit(0) | bit(14) | bit(23) | bit(25));  // TIM2, SPI2, USB, FDCAN
  reset_register.write(0);
}
/// System reset, after all stores have reached memory.
[[noreturn]] inline void reset() {
  asm volatile("dsb" ::: "memory");
  kAircr.write(kResetRequest);
  for (;;) asm volatile("wfi");
}
}  // namespace core_reg

/// No interrupt while one of these lives.
class InterruptLock {
 public:
  InterruptLock() { asm volatile("mrs %0, primask\n cpsid i" : "=r"(saved_)::"memory"); }
  ~InterruptLock() { asm volatile("msr primask, %0" ::"r"(saved_) : "memory"); }
  InterruptLock(const InterruptLock&) = delete;
  InterruptLock& operator=(const InterruptLock&) = delete;

 private:
  std::uint32_t saved_;
};

}  // namespace triskin::board
