// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <vector>

#include "triskin/mesh/surface.hpp"
#include "triskin/unfolding/seams.hpp"

namespace triskin::geometry {

/// Smallest bending radius under a module that lies at each face, mm, by face; infinity where the surface is flat. As
/// `bend_radius_mm` of a module (docs/design_file.md), with twelve points around in place of three corners: the way to
/// a point at the distance of a corner (17.3 mm) divided by the turn of the interpolated normal on it. Points past the
/// border do not count. Cost: thirteen closest points a face.
[[nodiscard]] std::vector<double> bending_radii(const Surface& surface);

/// Edges for UnfoldingOptions::seams that part what bends more than `radius_mm` > 0 from the rest, as the reference
/// paper cuts parts (Section VI-A, Fig. 17). Parts smaller than a module do not count: they go to what surrounds them.
/// Empty where nothing or everything bends so. Errors: InputError for a radius that is not positive. Deterministic.
/// Cost: that of bending_radii(). Source: docs/bending.md, limits of bending.
[[nodiscard]] std::vector<SurfaceEdge> seams_along_bends(const Surface& surface, double radius_mm);

}  // namespace triskin::geometry
