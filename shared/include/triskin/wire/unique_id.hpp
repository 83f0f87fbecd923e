// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <cstdint>

namespace triskin::wire {

/// The microcontroller is manufactured with a unique number of 96 bits, stored here in the order of its addresses.
using UniqueId = std::array<std::uint8_t, 12>;

}  // namespace triskin::wire
