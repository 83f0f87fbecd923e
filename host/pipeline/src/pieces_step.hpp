// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "choose_layout.hpp"
#include "design_in_work.hpp"
#include "searched_surface.hpp"
#include "triskin/mesh/surface_regions.hpp"

namespace triskin::pipeline {

/// True where flat pieces can hold as many modules as the growth: the curvature under a module is so small that few
/// seams are needed, as of plates, cylinders and cones (docs/measurements/unfolding.md), or where the options ask.
[[nodiscard]] bool are_pieces_tried(DesignInWork& work, const geometry::Surface& surface);

/// Unfolds the surface, places modules on each piece and maps them back; with controllers and jumpers. Pieces that are
/// not reached by `end_s` of the budget are left out, and counted in the notes. `regions` of the original, or null.
[[nodiscard]] WiredLayout layout_on_pieces(DesignInWork& work, const SearchedSurface& searched,
                                           const geometry::SurfaceRegions* regions, double end_s);

}  // namespace triskin::pipeline
