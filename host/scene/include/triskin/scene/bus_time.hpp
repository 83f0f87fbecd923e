// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "triskin/wire/can_frame.hpp"

namespace triskin::scene {

/// Length of a frame on the bus, bits.
struct FrameBits {
  int nominal = 0;  ///< sent at the nominal bit rate
  int data = 0;     ///< sent at the data bit rate
};
/// Length of `frame` with the largest number of stuff bits that can occur (ISO 11898-1), interframe space included.
[[nodiscard]] FrameBits bits_of(const wire::CanFrame& frame);

}  // namespace triskin::scene
