// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstdint>
#include <span>

namespace triskin::recording {

/// Reads `into.size()` bytes from `offset` of an open file; returns false if it ends before that, or on an error.
[[nodiscard]] bool read_at(int file, std::uint64_t offset, std::span<std::uint8_t> into);

}  // namespace triskin::recording
