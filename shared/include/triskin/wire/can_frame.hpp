// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <cstdint>
#include <span>

namespace triskin::wire {

/// One classic CAN or CAN FD data frame, independent of any driver's structure.
struct CanFrame {
  std::uint32_t id = 0;   ///< 11 or 29 bits, without flags
  bool extended = false;  ///< 29-bit identifier
  bool fd = false;
  bool bit_rate_switch = false;  ///< only with fd
  std::uint8_t size = 0;         ///< bytes, 0..8, with fd 0..64
  std::array<std::uint8_t, 64> data{};

  /// The bytes that the frame carries; valid as long as the frame.
  [[nodiscard]] constexpr std::span<const std::uint8_t> payload() const { return {data.data(), size}; }
  bool operator==(const CanFrame&) const = default;
};

}  // namespace triskin::wire
