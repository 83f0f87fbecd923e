// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "triskin/board/registers/chip.hpp"
#include "triskin/board/registers/register.hpp"

/// RM0440 §39.9 describes the registers of the I²C interface.
namespace triskin::board::i2c_reg {

// The address of I2C3 and the interrupts of I2C3 and I2C4 are those of the chip.
inline constexpr std::uint32_t kI2c1 = 0x40005400, kI2c2 = 0x40005800, kI2c4 = 0x40008400;
inline constexpr int kI2c1Event = 31, kI2c1Error = 32, kI2c2Event = 33, kI2c2Error = 34;

inline constexpr std::uint32_t kCr1 = 0x00, kCr2 = 0x04, kTimingr = 0x10, kTimeoutr = 0x14, kIsr = 0x18, kIcr = 0x1C,
                               kRxdr = 0x24, kTxdr = 0x28;

// These bits belong to CR1.
inline constexpr std::uint32_t kEnable = bit(0), kNackInterrupt = bit(4), kStopInterrupt = bit(5),
                               kCompleteInterrupt = bit(6), kErrorInterrupt = bit(7), kSendByDma = bit(14),
                               kReceiveByDma = bit(15);
// These fields belong to CR2.
inline constexpr std::uint32_t kRead = bit(10), kStart = bit(13), kBytesShift = 16, kAutoEnd = bit(25);
// These bits belong to ISR and ICR.
inline constexpr std::uint32_t kTxFlush = bit(0), kNack = bit(4), kStopSeen = bit(5), kComplete = bit(6),
                               kBusError = bit(8), kArbitrationLost = bit(9), kTimeout = bit(12), kBusy = bit(15);
// TIMEOUTR detects SCL low for longer than (TIMEOUTA + 1) · 2048 kernel clocks.
inline constexpr std::uint32_t kTimeoutEnable = bit(15);

}  // namespace triskin::board::i2c_reg
