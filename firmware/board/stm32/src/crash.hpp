// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>

namespace triskin::board {

/// Records the place that this exception frame interrupted, because the loop hangs, and resets.
[[noreturn]] void note_hang(const std::uint32_t* frame);

}  // namespace triskin::board
