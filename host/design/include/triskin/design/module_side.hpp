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

}  // namespace triskin::design
