// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "triskin/board/registers/register.hpp"

/// RM0394 describes the CAN block in its chapter on bxCAN: three transmit mailboxes, two receive FIFOs of three frames,
/// fourteen filters. It knows classic frames only.
namespace triskin::board::bxcan_reg {

inline constexpr std::uint32_t kBase = 0x40006400;
inline constexpr Register kMcr{kBase + 0x00}, kMsr{kBase + 0x04}, kTsr{kBase + 0x08}, kRf0r{kBase + 0x0C},
    kIer{kBase + 0x14}, kEsr{kBase + 0x18}, kBtr{kBase + 0x1C}, kFmr{kBase + 0x200}, kFm1r{kBase + 0x204},
    kFs1r{kBase + 0x20C}, kFfa1r{kBase + 0x214}, kFa1r{kBase + 0x21C};
// The mailboxes and the output of FIFO 0 have four registers each: identifier, length, and two words of data.
inline constexpr std::uint32_t kMailboxes = kBase + 0x180, kFifo0 = kBase + 0x1B0, kMailboxBytes = 0x10;
inline constexpr std::uint32_t kLength = 0x04, kDataLow = 0x08, kDataHigh = 0x0C;
// Each filter bank has two registers: with 32 bits and a mask these are the identifier and its mask.
inline constexpr std::uint32_t kFilterBanks = kBase + 0x240, kFilterBytes = 8, kFilterMask = 4;

// The block is controlled by these bits of MCR, and acknowledges the mode in MSR.
inline constexpr std::uint32_t kInitRequest = bit(0), kSleep = bit(1), kInOrder = bit(2);
inline constexpr std::uint32_t kInitAcknowledge = bit(0), kErrorInterrupt = bit(2);
// TSR tells which mailboxes have completed their request, which one is free, and whether any is.
inline constexpr std::uint32_t kCompleted = bit(0) | bit(8) | bit(16), kNextShift = 24, kNextMask = 3,
                               kAnyEmpty = 7U << 26;
// RF0R has the number of frames in FIFO 0, says that one was lost, and releases the oldest.
inline constexpr std::uint32_t kFramesMask = 3, kOverrun = bit(4), kRelease = bit(5);
// These bits of IER enable interrupts.
inline constexpr std::uint32_t kMailboxEmpty = bit(0), kFrameWaits = bit(1), kFrameLost = bit(3), kBusOff = bit(10),
                               kErrors = bit(15);
// These bits and fields belong to ESR.
inline constexpr std::uint32_t kWarning = bit(0), kPassive = bit(1), kOff = bit(2), kLastErrorShift = 4,
                               kLastErrorMask = 7, kSendErrorsShift = 16, kReceiveErrorsShift = 24, kCounterMask = 0xFF;
// The fields of BTR hold the value minus one.
inline constexpr std::uint32_t kBeforeShift = 16, kAfterShift = 20, kJumpShift = 24;
// These bits belong to the register with the identifier, of a mailbox, of a FIFO and of a filter.
inline constexpr std::uint32_t kTransmit = bit(0), kRemote = bit(1), kExtended = bit(2), kExtendedShift = 3,
                               kStandardShift = 21;
inline constexpr std::uint32_t kLengthMask = 0xF;
inline constexpr std::uint32_t kFilterInit = bit(0);  // This bit of FMR allows changes of filters.

}  // namespace triskin::board::bxcan_reg
