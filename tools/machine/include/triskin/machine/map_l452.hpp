// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstdint>

/// Lists what is elsewhere in the STM32L452 than in the STM32G474 (map.hpp): RM0394, memory map, vector table, RCC. Not
/// shared with the firmware: tests/firmware/silicon_l452 compares both with the same facts.
namespace triskin::machine::map::l452 {

inline constexpr std::uint32_t kI2c3 = 0x40005C00, kCrs = 0x40006000, kCan = 0x40006400, kUsb = 0x40006800,
                               kUsbMemory = 0x40006C00, kDma2 = 0x40020400;
inline constexpr unsigned kDma2Bit = 1, kI2c3Bit = 23, kCrsBit = 24, kCanBit = 25, kUsbBit = 26;
inline constexpr std::uint32_t kUsbSupplyValid = 0x400;  // The bit belongs to PWR_CR2.
inline constexpr int kCanSendIrq = 19, kCanReceiveIrq = 20, kCanStateIrq = 22, kUsbIrq = 67, kI2c3Event = 72,
                     kI2c3Error = 73, kI2c4Event = 83, kI2c4Error = 84;
inline constexpr std::uint32_t kAcrReset = 0x00000600, kRccCrReset = 0x00000063;

}  // namespace triskin::machine::map::l452
