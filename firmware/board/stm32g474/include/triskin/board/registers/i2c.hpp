// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "triskin/board/registers/register.hpp"

/// Inter-integrated circuit interface, RM0440 §41.9.
namespace triskin::board::i2c_reg {

inline constexpr std::uint32_t kCr1 = 0x00, kCr2 = 0x04, kTimingr = 0x10, kTimeoutr = 0x14, kIsr = 0x18, kIcr = 0x1C,
                               kRxdr = 0x24, kTxdr = 0x28;

// CR1
inline constexpr std::uint32_t kEnable = bit(0), kNackInterrupt = bit(4), kStopInterrupt = bit(5),
                               kCompleteInterrupt = bit(6), kErrorInterrupt = bit(7), kSendByDma = bit(14),
                               kReceiveByDma = bit(15);
// CR2
inline constexpr std::uint32_t kRead = bit(10), kStart = bit(13), kStop = bit(14), kBytesShift = 16, kAutoEnd = bit(25);
// ISR and ICR
inline constexpr std::uint32_t kTxFlush = bit(0), kNack = bit(4), kStopSeen = bit(5), kComplete = bit(6),
                               kBusError = bit(8), kArbitrationLost = bit(9), kTimeout = bit(12), kBusy = bit(15);
// TIMEOUTR: SCL low for longer than (TIMEOUTA + 1) · 2048 kernel clocks
inline constexpr std::uint32_t kTimeoutEnable = bit(15);

}  // namespace triskin::board::i2c_reg
