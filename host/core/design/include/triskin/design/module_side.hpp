// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstddef>

#include "triskin/design/module.hpp"

namespace triskin::design {

/// Returns the middle of side `side` (0 … 2) of a module, where its port is; mesh frame, mm.
[[nodiscard]] inline Vec3 middle_of_side(const PlacedModule& module, int side) {
  const auto s = static_cast<std::size_t>(side);
  return 0.5 * (module.corner_mm[s] + module.corner_mm[(s + 1) % 3]);
}

/// Returns the port, 0 for A … 2 for C, that lies at side `side` (0 … 2) of a module whose port A lies at side
/// `rotation` (0 … 2).
[[nodiscard]] constexpr int port_at_side(int side, int rotation) {
  return (side + 3 - rotation) % 3;
}

}  // namespace triskin::design
