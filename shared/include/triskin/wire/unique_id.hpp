// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <cstdint>

namespace triskin::wire {

/// Unique number of a controller: the 96 bits that the microcontroller was made with, in order of their addresses.
using UniqueId = std::array<std::uint8_t, 12>;

}  // namespace triskin::wire
