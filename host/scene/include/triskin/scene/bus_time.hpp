// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "triskin/wire/can_frame.hpp"

namespace triskin::scene {

/// Bit length of a frame on the bus, with the most stuff bits that can occur (ISO 11898-1).
struct FrameBits {
  int nominal = 0;
  int data = 0;  ///< sent at the data bit rate
};
[[nodiscard]] FrameBits bits_of(const wire::CanFrame& frame);

}  // namespace triskin::scene
