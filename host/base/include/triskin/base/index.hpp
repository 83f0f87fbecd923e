// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstddef>

namespace triskin {

/// Vertices, faces and modules are numbered with int, of which −1 is none; vectors want something else.
[[nodiscard]] constexpr std::size_t at(int k) {
  return static_cast<std::size_t>(k);
}

}  // namespace triskin
