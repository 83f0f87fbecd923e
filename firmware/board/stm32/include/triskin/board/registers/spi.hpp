// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "triskin/board/registers/register.hpp"

/// RM0440 §42.9 describes the serial peripheral interface; we use SPI2.
namespace triskin::board::spi_reg {

inline constexpr std::uint32_t kSpi2 = 0x40003800;
inline constexpr Register kCr1{kSpi2 + 0x00}, kCr2{kSpi2 + 0x04}, kSr{kSpi2 + 0x08};
inline constexpr std::uint32_t kData = kSpi2 + 0x0C;  ///< The access may be 8 or 16 bits wide: see put() and get().
inline constexpr std::uint32_t kMaster = bit(2), kClockBy64 = 5U << 3, kEnable = bit(6), kInternalSelect = bit(8),
                               kSoftwareSelect = bit(9);
inline constexpr std::uint32_t kEightBits = 7U << 8, kReceiveByte = bit(12);  // These fields are DS and FRXTH.
inline constexpr std::uint32_t kReceived = bit(0), kRoom = bit(1), kBusy = bit(7);

/// Sends one byte; a wider access would pack two frames (§42.5.9).
inline void put(std::uint8_t byte) {
  *reinterpret_cast<volatile std::uint8_t*>(kData) = byte;
}
/// Returns one received byte. Read kReceived first, because the register repeats old data.
[[nodiscard]] inline std::uint8_t get() {
  return *reinterpret_cast<volatile std::uint8_t*>(kData);
}

}  // namespace triskin::board::spi_reg
