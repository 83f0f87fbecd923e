// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "triskin/board/registers/register.hpp"

/// These registers and bits of the STM32L452 are not the same in the other chips of firmware/board. Drivers that all
/// chips share use them by these names; what this chip does not have is 0. The chapters are those of RM0394 (STM32L41
/// to STM32L46 reference manual).
namespace triskin::board {

/// RM0394 describes the embedded flash in its chapter of that name: one bank of pages of 2 KB.
namespace flash_reg {
inline constexpr std::uint32_t kLatencyMask = 7;  // The field belongs to ACR.
inline constexpr std::uint32_t kBank2 = 0, kEccDetectedHigh = 0, kEccCorrectedHigh = 0, kDualBank = 0;
inline constexpr std::uint32_t kProtectedPageMask = 0xFF, kProtectsNothing = 0xFF;  // The fields belong to WRP1AR.
}  // namespace flash_reg

/// RM0394 describes the power control in its chapter of that name. VDDUSB feeds the transceiver only when CR2.USV says
/// that it is there; USB is dead without it.
namespace pwr_reg {
inline constexpr Register kUsbSupply{0x40007004};
inline constexpr std::uint32_t kUsbSupplyValid = bit(10);
}  // namespace pwr_reg

/// RM0394 describes the reset and clock control in its chapter of that name.
namespace rcc_reg {
inline constexpr std::uint32_t kHsiOn = bit(8), kHsiReady = bit(10), kHseBypass = bit(18);  // The bits belong to CR.
inline constexpr std::uint32_t kDma2 = bit(1);                                   // This clock is enabled in AHB1ENR.
inline constexpr std::uint32_t kCrs = bit(24), kUsb = bit(26), kI2c3 = bit(23);  // These are enabled in APB1ENR1.
}  // namespace rcc_reg

namespace i2c_reg {
inline constexpr std::uint32_t kI2c3 = 0x40005C00;
inline constexpr int kI2c3Event = 72, kI2c3Error = 73, kI2c4Event = 83, kI2c4Error = 84;
}  // namespace i2c_reg

/// A channel has fixed requests, of which CSELR selects one with four bits per channel (chapter on the DMA controller).
namespace dma_reg {
inline constexpr std::uint32_t kDma2 = 0x40020400, kSelection = 0xA8, kSelectionBits = 4;
/// The requests of I2C1, I2C2 and I2C3 have the first number in their channels of DMA1, those of I2C4 the second one in
/// DMA2.
inline constexpr std::uint32_t kI2cRequest = 3, kI2c4Request = 0;
}  // namespace dma_reg

/// The USART has no FIFO.
namespace usart_reg {
inline constexpr std::uint32_t kFifo = 0;
}  // namespace usart_reg

namespace usb_reg {
inline constexpr std::uint32_t kBase = 0x40006800, kMemory = 0x40006C00;
inline constexpr int kIrq = 67;
}  // namespace usb_reg
namespace crs_reg {
inline constexpr Register kCr{0x40006000};
}  // namespace crs_reg

/// CAN1 has four interrupts: transmission, both receive FIFOs, changes of state.
namespace can_irq {
inline constexpr int kFirst = 19, kLast = 22;
}  // namespace can_irq

}  // namespace triskin::board
