// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "triskin/board/registers/register.hpp"

/// These registers and bits of the STM32G474 are not the same in the other chips of firmware/board. Drivers that all
/// chips share use them by these names.
namespace triskin::board {

/// RM0440 §3.7 describes the embedded flash (category 3 device) with two banks.
namespace flash_reg {
inline constexpr std::uint32_t kLatencyMask = 0xF;  // The field belongs to ACR.
inline constexpr std::uint32_t kBank2 = bit(11);    // The bit belongs to CR.
// These bits of ECCR are for the upper half with DBANK = 0.
inline constexpr std::uint32_t kEccDetectedHigh = bit(29), kEccCorrectedHigh = bit(28);
inline constexpr std::uint32_t kDualBank = bit(22);                                 // The bit belongs to OPTR.
inline constexpr std::uint32_t kProtectedPageMask = 0x7F, kProtectsNothing = 0x7F;  // The fields belong to WRP1AR.
}  // namespace flash_reg

/// RM0440 §6.4 describes the power control.
namespace pwr_reg {
inline constexpr std::uint32_t kBase = 0x40007000;
inline constexpr Register kCr1{kBase + 0x00}, kCr5{kBase + 0x80};
inline constexpr std::uint32_t kNoBoost = bit(8);  // R1MODE must be 0 above 150 MHz (§6.1.5).
/// The supply of USB needs no switch (CR2 has none).
inline constexpr Register kUsbSupply{kBase + 0x04};
inline constexpr std::uint32_t kUsbSupplyValid = 0;
}  // namespace pwr_reg

/// RM0440 §7.4 describes the reset and clock control.
namespace rcc_reg {
inline constexpr std::uint32_t kAhbHalf = 0x80, kPllMMask = 0xF;
inline constexpr std::uint32_t kDmaMux = bit(2);                                // This clock is enabled in AHB1ENR.
inline constexpr std::uint32_t kCrs = bit(8), kUsb = bit(23), kI2c3 = bit(30);  // These are enabled in APB1ENR1.
inline constexpr std::uint32_t kTim16 = bit(17);                                // This clock is enabled in APB2ENR.
inline constexpr std::uint32_t kFdcanFromPclk1 = 2U << 24;  // CCIPR.FDCANSEL selects PCLK1 as the clock of FDCAN.
}  // namespace rcc_reg

/// RM0440 §39.9 describes the registers of the I²C interface.
namespace i2c_reg {
inline constexpr std::uint32_t kI2c3 = 0x40007800;
inline constexpr int kI2c3Event = 92, kI2c3Error = 93, kI2c4Event = 82, kI2c4Error = 83;
}  // namespace i2c_reg

/// RM0440 §13.6 describes the multiplexer that connects a request to a channel of DMA1.
namespace dma_reg {
inline constexpr std::uint32_t kMuxBase = 0x40020800, kMuxChannelBytes = 4;
// Requests of I2C1 are from table 91; each further line has the next two.
inline constexpr std::uint32_t kI2c1Receive = 16, kI2c1Send = 17, kI2cRequests = 2;
}  // namespace dma_reg

/// RM0440 §40.8 describes the USART.
namespace usart_reg {
inline constexpr std::uint32_t kFifo = bit(29);  // The bit belongs to CR1.
}  // namespace usart_reg

/// RM0440 §45.6 describes the USB full-speed device, §8.7 the clock recovery system.
namespace usb_reg {
inline constexpr std::uint32_t kBase = 0x40005C00, kMemory = 0x40006000;
inline constexpr int kIrq = 20;
}  // namespace usb_reg
namespace crs_reg {
inline constexpr Register kCr{0x40002000};
}  // namespace crs_reg

/// FDCAN1 has one interrupt.
namespace can_irq {
inline constexpr int kFirst = 21, kLast = 21;
}  // namespace can_irq

}  // namespace triskin::board
