// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <cstdint>
#include <span>

namespace triskin::wire {

/// One classic CAN or CAN FD data frame, independent of any driver's structure.
struct CanFrame {
  std::uint32_t id = 0;   ///< It has 11 or 29 bits and no flags.
  bool extended = false;  ///< It says that the identifier has 29 bits.
  bool fd = false;
  bool bit_rate_switch = false;  ///< It is only meaningful for an FD frame.
  std::uint8_t size = 0;         ///< It ranges from 0 to 8 bytes, and to 64 for an FD frame.
  std::array<std::uint8_t, 64> data{};

  /// The bytes that the frame carries; valid as long as the frame.
  [[nodiscard]] constexpr std::span<const std::uint8_t> payload() const { return {data.data(), size}; }
  bool operator==(const CanFrame&) const = default;
};

}  // namespace triskin::wire
