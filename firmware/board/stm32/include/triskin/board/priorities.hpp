// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>

/// In the NVIC, priority 0 is the most urgent, and the upper four bits count (RM0440 §14.1). Handlers of one priority
/// do not interrupt each other, so the stack holds at most one handler for each number here, and the NMI.
/// tools/check_stack.py reads them.
namespace triskin::board::priority {

inline constexpr std::uint8_t kTimer = 0x00;  ///< TIM2 ends a sleep, so its interrupt comes first.
inline constexpr std::uint8_t kLines = 0x40;  ///< Events and errors of I2C1 … I2C4 have this priority.
inline constexpr std::uint8_t kCan = 0x80;
inline constexpr std::uint8_t kUsb = 0xC0;

}  // namespace triskin::board::priority
