// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "triskin/mesh/surface.hpp"

namespace triskin::geometry {

/// Integrates |Gaussian curvature| over the inside of a surface, rad: it adds |2π − angles around the vertex| over
/// all vertices that are not on the border. Planes, cylinders and cones, which unfold without strain, have 0; a sphere
/// and a box have 4π. Cost: linear in the faces. Source: Meyer et al. 2003, discrete Gauss–Bonnet.
[[nodiscard]] double total_curvature_rad(const Surface& surface);

}  // namespace triskin::geometry
