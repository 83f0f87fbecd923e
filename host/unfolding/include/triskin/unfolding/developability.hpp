// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "triskin/mesh/surface.hpp"

namespace triskin::geometry {

/// Integral of |Gaussian curvature| over the inside of a surface, rad: the sum of |2π − angles around the vertex| over
/// the vertices that are not on the border. 0 of planes, cylinders and cones (developable surfaces, which unfold
/// without strain), 4π of a sphere and of a box. Cost: linear in the faces. Source: Meyer et al. 2003, discrete
/// Gauss–Bonnet.
[[nodiscard]] double total_curvature_rad(const Surface& surface);

}  // namespace triskin::geometry
