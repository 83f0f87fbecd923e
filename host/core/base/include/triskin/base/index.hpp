// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstddef>

namespace triskin {

/// Vertices, faces and modules have int numbers, and −1 means none; vectors need std::size_t.
[[nodiscard]] constexpr std::size_t at(int k) {
  return static_cast<std::size_t>(k);
}

}  // namespace triskin
