// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <cstdint>
#include <span>

namespace triskin::wire {

/// A frame is a classic CAN or CAN FD data frame, independent of any driver's structure.
struct CanFrame {
  std::uint32_t id = 0;   ///< The identifier has 11 or 29 bits and contains no flags.
  bool extended = false;  ///< True means that the identifier has 29 bits.
  bool fd = false;
  bool bit_rate_switch = false;  ///< The rate switch only matters for an FD frame.
  std::uint8_t size = 0;         ///< A frame carries 0 to 8 bytes, an FD frame up to 64.
  std::array<std::uint8_t, 64> data{};

  /// Returns the bytes that the frame carries; the view is valid as long as the frame.
  [[nodiscard]] constexpr std::span<const std::uint8_t> payload() const { return {data.data(), size}; }
  bool operator==(const CanFrame&) const = default;
};

}  // namespace triskin::wire
