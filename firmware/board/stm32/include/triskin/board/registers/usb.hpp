// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "triskin/board/registers/chip.hpp"
#include "triskin/board/registers/register.hpp"

namespace triskin::board {

/// RM0440 §45.6 describes the USB full-speed device; its packet memory of 1 KB is accessed in half-words (§45.5.3).
/// Its addresses are those of the chip.
namespace usb_reg {
inline constexpr Register kCntr{kBase + 0x40}, kIstr{kBase + 0x44}, kDaddr{kBase + 0x4C}, kBtable{kBase + 0x50},
    kBcdr{kBase + 0x58};
/// Returns the register EPnR of endpoint register n, 0..7.
[[nodiscard]] constexpr Register endpoint(std::size_t n) {
  return Register(kBase + 4 * static_cast<std::uint32_t>(n));
}
// The USB device is switched on and off by these bits of its control register CNTR.
inline constexpr std::uint32_t kForceReset = bit(0), kPowerDown = bit(1), kForceSuspend = bit(3);
// These bits belong to CNTR (as masks) and ISTR.
inline constexpr std::uint32_t kReset = bit(10), kSuspend = bit(11), kWakeUp = bit(12), kTransferred = bit(15);
// In EPnR some bits are cleared by 0 and some are toggled by 1 (§45.6.2).
inline constexpr std::uint32_t kReceived = bit(15), kReceiveToggle = bit(14), kReceiveMask = 3U << 12, kSetup = bit(11),
                               kSent = bit(7), kSendToggle = bit(6), kSendMask = 3U << 4, kPlain = 0x70F;
inline constexpr std::uint32_t kBulk = 0U << 9, kControl = 1U << 9, kInterrupt = 3U << 9;
inline constexpr std::uint32_t kStall = 1, kNak = 2, kValid = 3;  // Both status fields use these values.
inline constexpr unsigned kReceiveShift = 12, kSendShift = 4;
inline constexpr std::uint32_t kEnableFunction = bit(7);  // The device answers only while this bit of DADDR is set.
inline constexpr std::uint32_t kPullUp = bit(15);         // The pull-up on D+ is switched by BCDR.
inline constexpr std::uint32_t kBlocksOf64 = bit(15) | 1U << 10,
                               kCountMask = 0x3FF;  // COUNTn_RX is set to two blocks of 32 bytes.
}  // namespace usb_reg

/// The clock recovery system (§8.7) keeps the 48 MHz oscillator synchronized with the host's frames.
namespace crs_reg {
inline constexpr std::uint32_t kEnable = bit(5), kAutomatic = bit(6);
}  // namespace crs_reg

}  // namespace triskin::board
