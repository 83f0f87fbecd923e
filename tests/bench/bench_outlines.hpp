// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "triskin/placement/polygon_io.hpp"

namespace triskin::cli {

/// Makes a star-shaped outline of `vertices` vertices and `area_cm2`: radii that differ by ±25% from vertex to vertex
/// (rough), or a few waves. The seed follows from the arguments, so that each outline can be made again alone.
[[nodiscard]] design::Polygon bench_outline(bool rough, int vertices, double area_cm2);

/// Makes a smooth outline with `cracks` slits from the border inwards, as unfolding leaves them: each reaches `depth`
/// of the radius deep. Needs vertices ≥ 3 · cracks + 3.
[[nodiscard]] design::Polygon cracked_outline(int vertices, double area_cm2, int cracks, double depth);

}  // namespace triskin::cli
