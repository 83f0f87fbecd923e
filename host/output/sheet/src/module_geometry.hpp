// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstddef>

#include "triskin/design/design.hpp"

namespace triskin::sheet {

/// Modules are numbered with int, but vectors need std::size_t.
[[nodiscard]] constexpr std::size_t index(int value) {
  return static_cast<std::size_t>(value);
}

/// Returns the mean of the corners of a module, mm.
[[nodiscard]] inline design::Vec3 center_of(const design::PlacedModule& m) {
  return (m.corner_mm[0] + m.corner_mm[1] + m.corner_mm[2]) / 3.0;
}

}  // namespace triskin::sheet
