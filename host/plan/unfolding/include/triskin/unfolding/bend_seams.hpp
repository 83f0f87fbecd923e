// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <vector>

#include "triskin/mesh/surface.hpp"
#include "triskin/unfolding/seams.hpp"

namespace triskin::unfolding {

/// Returns the smallest bending radius in mm under a module that lies at each face; infinity on a flat surface. It is
/// defined as `bend_radius_mm` of a module (docs/design_file.md), with twelve points around in place of three corners:
/// the path to a point at the distance of a corner (17.3 mm) divided by the turn of the interpolated normal along it.
/// Points past the border do not count. Cost: thirteen closest points per face.
[[nodiscard]] std::vector<double> bending_radii(const mesh::Surface& surface);

/// Returns edges for UnfoldingOptions::seams that separate surface bent by more than `radius_mm` > 0 from the rest, as
/// the reference paper cuts parts (Section VI-A, Fig. 17). Parts smaller than a module join their surroundings. Empty
/// if nothing or everything is bent so much. Errors: InputError for a radius that is not positive. Deterministic. Cost:
/// that of bending_radii(). Source: docs/limits.md, limits of bending.
[[nodiscard]] std::vector<SurfaceEdge> seams_along_bends(const mesh::Surface& surface, double radius_mm);

}  // namespace triskin::unfolding
