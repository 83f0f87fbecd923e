// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "triskin/board/registers/chip.hpp"
#include "triskin/board/registers/gpio.hpp"
#include "triskin/board/registers/register.hpp"

namespace triskin::board {

/// RM0440 §3.7 describes the embedded flash. The chip adds its banks.
namespace flash_reg {
inline constexpr std::uint32_t kBase = 0x40022000;
inline constexpr Register kAcr{kBase + 0x00}, kKeyr{kBase + 0x08}, kOptKeyr{kBase + 0x0C}, kSr{kBase + 0x10},
    kCr{kBase + 0x14}, kEccr{kBase + 0x18}, kOptr{kBase + 0x20}, kWrp1Ar{kBase + 0x2C};
// §3.7.3 defines the keys that unlock the flash.
inline constexpr std::uint32_t kKey1 = 0x45670123, kKey2 = 0xCDEF89AB;
// §3.7.4 defines the keys that unlock the option bytes.
inline constexpr std::uint32_t kOptionKey1 = 0x08192A3B, kOptionKey2 = 0x4C5D6E7F;
// The access control register ACR has the wait states and the caches of the flash.
inline constexpr std::uint32_t kLatency4 = 4, kPrefetch = bit(8), kInstructionCache = bit(9), kDataCache = bit(10),
                               kDataCacheReset = bit(12);
// The status register SR tells when an operation has ended.
inline constexpr std::uint32_t kEndOfOperation = bit(0), kBusy = bit(16);
inline constexpr std::uint32_t kErrors = bit(1) | bit(3) | bit(4) | bit(5) | bit(6) | bit(7) | bit(8) | bit(9);
// The control register CR selects the operation of the flash and its page.
inline constexpr std::uint32_t kProgram = bit(0), kPageErase = bit(1), kPageShift = 3, kStart = bit(16),
                               kOptionStart = bit(17), kOptionLock = bit(30), kLock = bit(31);
// ECCR reports two wrong bits with an NMI and one wrong bit as corrected.
inline constexpr std::uint32_t kEccDetected = bit(31), kEccCorrected = bit(30);
// OPTR has the read protection, BOOT0 from the pin, and BOOT0 of the option (inverted).
inline constexpr std::uint32_t kReadProtectionMask = 0xFF, kNotProtected = 0xAA, kBootByPin = bit(26),
                               kBootOptionFlash = bit(27), kBrownOutMask = 7U << 8,
                               kBrownOut28 = 4U << 8;  // Level 4 is about 2.8 V.
// WRP1AR has the first and last protected page of bank 1; a first page after the last one protects nothing.
inline constexpr std::uint32_t kLastProtectedShift = 16;
}  // namespace flash_reg

/// RM0440 §7.4 describes the reset and clock control. The chip adds the bits that others do not have in this place.
namespace rcc_reg {
inline constexpr std::uint32_t kBase = 0x40021000;
inline constexpr Register kCr{kBase + 0x00}, kCfgr{kBase + 0x08}, kPllCfgr{kBase + 0x0C}, kAhb1Enr{kBase + 0x48},
    kAhb2Enr{kBase + 0x4C}, kApb1Enr1{kBase + 0x58}, kApb1Enr2{kBase + 0x5C}, kApb2Enr{kBase + 0x60},
    kApb1Rstr1{kBase + 0x38}, kApb2Rstr{kBase + 0x40}, kCifr{kBase + 0x1C}, kCicr{kBase + 0x20}, kCcipr{kBase + 0x88},
    kCsr{kBase + 0x94}, kCrrcr{kBase + 0x98}, kCcipr2{kBase + 0x9C};
inline constexpr std::uint32_t kHseOn = bit(16), kHseReady = bit(17), kClockSecurity = bit(19), kPllOn = bit(24),
                               kPllReady = bit(25);
inline constexpr std::uint32_t kCrystalFailed = bit(8);  // The bit belongs to CIFR and CICR.
inline constexpr std::uint32_t kSwitchMask = 3, kSwitchHsi = 1, kSwitchHse = 2, kSwitchPll = 3, kStatusShift = 2,
                               kAhbMask = 0xF0;
inline constexpr std::uint32_t kPllFromHse = 3, kPllFromHsi = 2, kPllMShift = 4, kPllNShift = 8, kPllREnable = bit(24),
                               kPllSourceMask = 3, kPllNMask = 0x7F;
inline constexpr std::uint32_t kDma1 = bit(0), kFlashClock = bit(8), kGpioA = bit(0), kGpioB = bit(1), kGpioC = bit(2);
inline constexpr std::uint32_t kTim2 = bit(0), kSpi2 = bit(14), kUsart2 = bit(17), kI2c1 = bit(21), kI2c2 = bit(22),
                               kCan = bit(25), kPwr = bit(28);  // These clocks are enabled in APB1ENR1.
inline constexpr std::uint32_t kI2c4 = bit(1);                  // This clock is enabled in APB1ENR2.
inline constexpr std::uint32_t kHsi48On = bit(0), kHsi48Ready = bit(1);
inline constexpr std::uint32_t kRemoveResetFlags = bit(23), kOptionReset = bit(25), kPinReset = bit(26),
                               kPowerReset = bit(27), kSoftwareReset = bit(28), kWatchdogReset = bit(29);
}  // namespace rcc_reg

/// Enables the clock of a pin's port, which must happen before any other access to the pin.
inline void open_port(Pin pin) {
  rcc_reg::kAhb2Enr.set(rcc_reg::kGpioA << static_cast<unsigned>(pin.port - 'A'));
  (void)rcc_reg::kAhb2Enr.read();
}

/// RM0440 §30.5 describes TIM2, a general-purpose timer with 32 bits.
namespace tim2_reg {
inline constexpr std::uint32_t kBase = 0x40000000;
inline constexpr Register kCr1{kBase + 0x00}, kDier{kBase + 0x0C}, kSr{kBase + 0x10}, kEgr{kBase + 0x14},
    kCnt{kBase + 0x24}, kPsc{kBase + 0x28}, kArr{kBase + 0x2C}, kCcr1{kBase + 0x34}, kCcr2{kBase + 0x38};
inline constexpr std::uint32_t kEnable = bit(0), kCompare1 = bit(1), kCompare2 = bit(2), kUpdate = bit(0);
inline constexpr int kIrq = 28;
}  // namespace tim2_reg

/// RM0440 §35.4 describes the independent watchdog, which runs from the 32 kHz oscillator and cannot be stopped.
namespace iwdg_reg {
inline constexpr std::uint32_t kBase = 0x40003000;
inline constexpr Register kKr{kBase + 0x00}, kPr{kBase + 0x04}, kRlr{kBase + 0x08}, kSr{kBase + 0x0C};
inline constexpr std::uint32_t kStart = 0xCCCC, kUnlock = 0x5555, kReload = 0xAAAA;
inline constexpr std::uint32_t kPrescaler32 = 3;
}  // namespace iwdg_reg

/// The debug unit stops counters while a debugger holds the core (RM0440, chapter on debug support; RM0394 has it at
/// the same place). Only power-up resets the register.
namespace debug_reg {
inline constexpr Register kApb1Freeze{0xE0042008};
inline constexpr std::uint32_t kTim2Stands = bit(0), kWatchdogStands = bit(12);
}  // namespace debug_reg

/// The unique device id of 96 bits begins here (§48).
inline constexpr std::uint32_t kUniqueIdAddress = 0x1FFF7590;

/// The ARMv7-M architecture reference manual, B3.2 … B3.4, describes the system control space of the Cortex-M4.
namespace core_reg {
inline constexpr Register kSysTickCsr{0xE000E010}, kSysTickRvr{0xE000E014}, kSysTickCvr{0xE000E018}, kIcsr{0xE000ED04},
    kVtor{0xE000ED08}, kAircr{0xE000ED0C}, kCpacr{0xE000ED88}, kCfsr{0xE000ED28}, kHfsr{0xE000ED2C}, kMmfar{0xE000ED34},
    kBfar{0xE000ED38};
inline constexpr Register kEnableFirst{0xE000E100}, kDisableFirst{0xE000E180}, kUnpendFirst{0xE000E280},
    kPriorityFirst{0xE000E400};
inline constexpr std::uint32_t kResetRequest = 0x05FA0004, kFpuFull = 0xFU << 20, kActiveMask = 0x1FF;
// CFSR says whether the frame could not be pushed, and whether MMFAR or BFAR has the address.
inline constexpr std::uint32_t kStackingFailed = bit(12) | bit(4), kMmfarValid = bit(7), kBfarValid = bit(15);
// In EXC_RETURN this bit is 0 if the frame has the registers of the FPU.
inline constexpr std::uint32_t kExtendedFrame = bit(4);
/// Enables interrupt `irq` (0..101, RM0440 chapter 14) in the NVIC.
inline void enable_interrupt(int irq) {
  Register(kEnableFirst.address() + 4U * static_cast<unsigned>(irq / 32)).write(bit(static_cast<unsigned>(irq % 32)));
}
/// Sets the priority of an interrupt: the upper four bits count, 0 is the most urgent.
inline void set_priority(int irq, std::uint8_t priority) {
  *reinterpret_cast<volatile std::uint8_t*>(kPriorityFirst.address() + static_cast<unsigned>(irq)) = priority;
}
/// Disables every interrupt and resets the peripherals of APB1 (RCC_APB1RSTR1, §7.4.14).
inline void reset_peripherals() {
  for (std::uint32_t k = 0; k < 4; ++k) Register(kDisableFirst.address() + 4 * k).write(0xFFFFFFFF);
  for (std::uint32_t k = 0; k < 4; ++k) Register(kUnpendFirst.address() + 4 * k).write(0xFFFFFFFF);
  using namespace rcc_reg;  // A block has the same bit in the reset register as in the enable register.
  kApb1Rstr1.write(kTim2 | kSpi2 | kUsart2 | kUsb | kCan);
  kApb1Rstr1.write(0);
}
/// Resets the system after all stores have reached memory.
[[noreturn]] inline void reset() {
  asm volatile("dsb" ::: "memory");
  kAircr.write(kResetRequest);
  for (;;) asm volatile("wfi");
}
}  // namespace core_reg

/// Disables interrupts while an object of this class exists.
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
