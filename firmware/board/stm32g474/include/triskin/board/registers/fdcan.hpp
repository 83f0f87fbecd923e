// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "triskin/board/registers/register.hpp"

/// RM0440 describes the FDCAN registers in §44.4 and the message RAM in §44.3.6; its layout is fixed in the STM32G4.
namespace triskin::board::fdcan_reg {

inline constexpr std::uint32_t kBase = 0x40006400, kRam = 0x4000A400;
inline constexpr Register kDbtp{kBase + 0x0C}, kCccr{kBase + 0x18}, kNbtp{kBase + 0x1C}, kEcr{kBase + 0x40},
    kPsr{kBase + 0x44}, kTdcr{kBase + 0x48}, kIr{kBase + 0x50}, kIe{kBase + 0x54}, kIls{kBase + 0x58},
    kIle{kBase + 0x5C}, kRxgfc{kBase + 0x80}, kRxf0s{kBase + 0x90}, kRxf0a{kBase + 0x94}, kTxbc{kBase + 0xC0},
    kTxfqs{kBase + 0xC4}, kTxbar{kBase + 0xCC}, kTxbtie{kBase + 0xDC}, kCkdiv{kBase + 0x100};

// The CAN controller is configured by these bits of its control register CCCR.
inline constexpr std::uint32_t kInit = bit(0), kConfigure = bit(1), kRestricted = bit(2), kFdOperation = bit(8),
                               kBitRateSwitch = bit(9);
// These bits belong to IR and IE.
inline constexpr std::uint32_t kRxNew = bit(0), kRxLost = bit(2), kTxDone = bit(7), kRamFailed = bit(14),
                               kBusOff = bit(19);
// These fields belong to ECR and PSR.
inline constexpr std::uint32_t kSendErrorsMask = 0xFF, kReceiveErrorsShift = 8, kReceiveErrorsMask = 0x7F,
                               kLastErrorMask = 7, kPsrPassive = bit(5), kPsrWarning = bit(6), kPsrBusOff = bit(7);
// These shifts belong to NBTP, DBTP (whose fields hold the value minus one) and RXGFC.
inline constexpr std::uint32_t kNominalJumpShift = 25, kNominalPrescalerShift = 16, kNominalBeforeShift = 8,
                               kDataPrescalerShift = 16, kDataBeforeShift = 8, kDataAfterShift = 4,
                               // These fields belong to DBTP and TDCR.
    kDelayCompensation = bit(23), kDelayOffsetShift = 8;
inline constexpr std::uint32_t kExtendedCountShift = 24, kStandardCountShift = 16, kOtherStandardShift = 4,
                               kOtherExtendedShift = 2, kRefuseRemote = 3;
// RXF0S tells how many frames are in the receive FIFO, and which one is next.
inline constexpr std::uint32_t kFifoLevelMask = 0xF, kFifoGetShift = 8, kFifoIndexMask = 3;
// TXFQS tells which transmit buffer is free, or that none is.
inline constexpr std::uint32_t kTxPutShift = 16, kTxFull = bit(21);
// The message RAM has these byte offsets.
inline constexpr std::uint32_t kStandardFilters = 0x000, kExtendedFilters = 0x070, kRxFifo0 = 0x0B0, kTxBuffers = 0x278,
                               kElementBytes = 72, kRamBytes = 0x350;
// A filter element has identifier and mask and stores into FIFO 0.
inline constexpr std::uint32_t kMaskFilter = 2U << 30, kFilterIdShift = 16, kStandardToFifo0 = 1U << 27,
                               kExtendedToFifo0 = 1U << 29;
// These bits belong to the first and second word of an element.
inline constexpr std::uint32_t kExtendedId = bit(30), kFdFrame = bit(21), kRateSwitched = bit(20), kSizeShift = 16,
                               kStandardIdShift = 18;

}  // namespace triskin::board::fdcan_reg
