// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstddef>

#include "triskin/design/outline.hpp"
#include "triskin/mesh/surface.hpp"

namespace triskin::lattice {

struct Overrun {
  double mm = 0.0;  ///< The value is never too large, and at most 0.02 mm too small.
  /// This many points of the module were compared with surface and border, as a measure of the cost.
  std::size_t points = 0;
};

/// Returns the overrun of a line over the border, or `known_mm` if none is larger. A larger `known_mm` is faster.
[[nodiscard]] Overrun overrun_of_line(const mesh::Surface& surface, const Vec3& from, const Vec3& to,
                                      double known_mm = 0.0);
/// Returns the overrun of a module, sides and area. Takes some hundred points if the border is near, also if the border
/// of another sheet runs along the surface under the module, as that of a rib that ends at the skin.
[[nodiscard]] Overrun overrun_of(const mesh::Surface& surface, const design::Outline& outline);

}  // namespace triskin::lattice
