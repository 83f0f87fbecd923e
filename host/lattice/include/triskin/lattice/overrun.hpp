// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstddef>

#include "triskin/design/outline.hpp"
#include "triskin/mesh/surface.hpp"

namespace triskin::geometry {

/// A measured overrun.
struct Overrun {
  double mm = 0.0;  ///< It is never too large, and too small by at most 0.02 mm.
  /// Number of points of the module that were compared with surface and border: a measure of the cost.
  std::size_t points = 0;
};

/// Overrun of a line over the border; `known_mm` where none is larger. A larger `known_mm` is faster.
[[nodiscard]] Overrun overrun_of_line(const Surface& surface, const Vec3& from, const Vec3& to, double known_mm = 0.0);
/// Overrun of a module, sides and area. Some hundred points where the border is near, also where the border of another
/// sheet runs along the surface under the module, as that of a rib that ends at the skin.
[[nodiscard]] Overrun overrun_of(const Surface& surface, const design::Outline& outline);

}  // namespace triskin::geometry
