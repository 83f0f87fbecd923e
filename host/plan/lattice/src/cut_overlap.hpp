// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "overlap.hpp"

namespace triskin::lattice {

/// Does what overlap_of() does, for modules with cut corners whose whole triangles overlap (otherwise neither do they).
/// Its corners are those of the triangles that are nearest to the touching points of the outlines.
[[nodiscard]] Overlap overlap_of_cut(const NetTriangle& a, const NetTriangle& b);

/// Does what pierced() does, for modules with cut corners that are near each other; the limit must be below their inner
/// radius.
[[nodiscard]] bool pierced_cut(const Triangle& a, const Triangle& b, double corner_cut_mm, double allowed_mm);

}  // namespace triskin::lattice
