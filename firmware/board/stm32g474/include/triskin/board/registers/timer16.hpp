// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "triskin/board/registers/register.hpp"

/// TIM16 measures the crystal: its channel 1 captures the count at edges of the crystal divided by 32. RM0440 chapter
/// 31.
namespace triskin::board::tim16_reg {

inline constexpr std::uint32_t kBase = 0x40014400;
inline constexpr Register kCr1{kBase + 0x00}, kSr{kBase + 0x10}, kEgr{kBase + 0x14}, kCcmr1{kBase + 0x18},
    kCcer{kBase + 0x20}, kCnt{kBase + 0x24}, kPsc{kBase + 0x28}, kArr{kBase + 0x2C}, kCcr1{kBase + 0x34},
    kTisel{kBase + 0x5C};
inline constexpr std::uint32_t kEnable = bit(0), kUpdate = bit(0), kCaptured = bit(1), kOvercaptured = bit(9);
// CCMR1 selects the input and that each eighth edge is captured.
inline constexpr std::uint32_t kCaptureFromInput = bit(0), kEachEighthEdge = 3U << 2;
inline constexpr std::uint32_t kCaptureOn = bit(0);  // The capture is enabled in CCER.
inline constexpr std::uint32_t kCrystalBy32 = 3;     // TISEL.TI1SEL connects the crystal divided by 32 to the channel.

}  // namespace triskin::board::tim16_reg
