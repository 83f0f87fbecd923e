// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>

namespace triskin::board {

/// The loop hangs: notes the place that this exception frame interrupted, and resets.
[[noreturn]] void note_hang(const std::uint32_t* frame);

}  // namespace triskin::board
