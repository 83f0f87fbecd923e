// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstdint>

/// Lists addresses of the blocks of the STM32G474, their clock enables, interrupts and reset values. Not shared with
/// the firmware: tests/firmware/silicon compares both with the same facts.
namespace triskin::machine::map {

inline constexpr std::uint32_t kTim2 = 0x40000000, kCrs = 0x40002000, kIwdg = 0x40003000, kSpi2 = 0x40003800,
                               kUsart2 = 0x40004400, kI2c1 = 0x40005400, kI2c2 = 0x40005800, kUsb = 0x40005C00,
                               kUsbMemory = 0x40006000, kFdcan = 0x40006400, kPwr = 0x40007000, kI2c3 = 0x40007800,
                               kI2c4 = 0x40008400, kFdcanRam = 0x4000A400, kTim16 = 0x40014400, kDma1 = 0x40020000,
                               kDmaMux = 0x40020800, kRcc = 0x40021000, kFlash = 0x40022000, kGpioA = 0x48000000,
                               kDebug = 0xE0042000;
inline constexpr std::uint32_t kCodeRam = 0x10000000, kCodeRamBytes = 0x8000, kRam = 0x20000000, kRamBytes = 0x18000,
                               kCodeRamAlias = 0x20018000, kFlashCells = 0x08000000, kUniqueId = 0x1FFF7590;

// These are enable registers (offsets in RCC) and bits in them.
inline constexpr std::uint32_t kApb1Reset = 0x38, kAhb1 = 0x48, kAhb2 = 0x4C, kApb1 = 0x58, kApb1Second = 0x5C,
                               kApb2 = 0x60;
inline constexpr unsigned kDma1Bit = 0, kDmaMuxBit = 2, kFlashBit = 8, kTim2Bit = 0, kCrsBit = 8, kSpi2Bit = 14,
                          kUsart2Bit = 17, kI2c1Bit = 21, kI2c2Bit = 22, kUsbBit = 23, kFdcanBit = 25, kPwrBit = 28,
                          kI2c3Bit = 30, kI2c4Bit = 1, kTim16Bit = 17;

inline constexpr int kUsbIrq = 20, kFdcanIrq = 21, kTim2Irq = 28, kI2c1Event = 31, kI2c1Error = 32, kI2c2Event = 33,
                     kI2c2Error = 34, kI2c4Event = 82, kI2c4Error = 83, kI2c3Event = 92, kI2c3Error = 93,
                     kInterrupts = 102;

// The alternate functions are for lines 1 and 2, lines 3 and 4, CAN, route chain and log.
inline constexpr unsigned kFunctionI2cFirst = 4, kFunctionI2cSecond = 8, kFunctionCan = 9, kFunctionSpi2 = 5,
                          kFunctionUsart2 = 7;

// Registers hold these values after a system reset.
inline constexpr std::uint32_t kAcrReset = 0x00040601, kFlashCrReset = 0xC0000000, kOptionsFromFactory = 0xFFEFF8AA;

}  // namespace triskin::machine::map
