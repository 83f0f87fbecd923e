// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstdint>

#include "triskin/wire/can_frame.hpp"

namespace triskin::machine {

/// Gives the length of a frame on the wire, from its start bit to the end of the interframe space, with its stuff bits.
struct CanBits {
  std::uint32_t nominal = 0;  ///< These bits are sent at the nominal rate.
  /// Only an FD frame has bits at the data rate: those between the switch of the rate and the CRC delimiter.
  std::uint32_t data = 0;
};

/// Counts the bits of `frame` (ISO 11898-1): a stuff bit of the other value follows five equal bits, up to the CRC of a
/// classic frame, up to the data of an FD frame, whose CRC field has fixed stuff bits. Cost: its bits.
[[nodiscard]] CanBits can_bits(const wire::CanFrame& frame);

/// An error frame has an error flag with its echoes (six to twelve bits), the delimiter (eight), and the interframe
/// space after it (three).
inline constexpr std::uint32_t kErrorFrameBits = 12 + 8 + 3;

}  // namespace triskin::machine
