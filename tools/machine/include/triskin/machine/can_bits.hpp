// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstdint>

#include "triskin/wire/can_frame.hpp"

namespace triskin::machine {

/// Length of a frame on the wire, from its start bit to the end of the interframe space, with its stuff bits.
struct CanBits {
  std::uint32_t nominal = 0;  ///< bits at the nominal rate
  std::uint32_t data = 0;     ///< bits of an FD frame between the switch of the rate and the CRC delimiter
};

/// Bits of `frame` (ISO 11898-1): after five equal bits one of the other value, up to the CRC of a classic frame, up to
/// the data of an FD frame, whose CRC field has fixed stuff bits. Cost: its bits.
[[nodiscard]] CanBits can_bits(const wire::CanFrame& frame);

/// An error flag, its echoes, the delimiter, and the interframe space after it, bits: six to twelve, eight, three.
inline constexpr std::uint32_t kErrorFrameBits = 12 + 8 + 3;

}  // namespace triskin::machine
