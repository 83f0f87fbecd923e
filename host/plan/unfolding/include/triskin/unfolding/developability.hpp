// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "triskin/mesh/surface.hpp"

namespace triskin::unfolding {

/// Returns the integral of |Gaussian curvature| over the inside of a surface, rad: the sum of
/// |2π − angles around the vertex| over the vertices that are not on the border. Planes, cylinders and cones
/// (developable surfaces, which unfold without strain) have 0; a sphere and a box have 4π. Cost: linear in the faces.
/// Source: Meyer et al. 2003, discrete Gauss–Bonnet.
[[nodiscard]] double total_curvature_rad(const mesh::Surface& surface);

}  // namespace triskin::unfolding
