// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "triskin/board/registers/chip.hpp"
#include "triskin/board/registers/register.hpp"

/// RM0440 §40.8 describes the USART; we use USART2.
namespace triskin::board::usart_reg {

inline constexpr std::uint32_t kUsart2 = 0x40004400;
inline constexpr Register kCr1{kUsart2 + 0x00}, kBrr{kUsart2 + 0x0C}, kIsr{kUsart2 + 0x1C}, kTdr{kUsart2 + 0x28};
inline constexpr std::uint32_t kEnable = bit(0), kTransmit = bit(3);  // The bits belong to CR1.
inline constexpr std::uint32_t kRoom = bit(7);  // In ISR this bit says that there is room for a byte.

}  // namespace triskin::board::usart_reg
