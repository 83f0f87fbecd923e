// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "choose_layout.hpp"
#include "design_in_work.hpp"
#include "searched_surface.hpp"
#include "triskin/mesh/surface_regions.hpp"

namespace triskin::pipeline {

/// Returns true if flat pieces may hold as many modules as the growth, because the curvature under a module is so small
/// that few seams are needed (plates, cylinders and cones, docs/measurements/unfolding.md), or if the options ask for
/// pieces.
[[nodiscard]] bool are_pieces_tried(DesignInWork& work, const mesh::Surface& surface);

/// Unfolds the surface, places modules on each piece, maps them back and prices the layout: with the best single
/// lattice of each piece, and, where the options ask for pieces and whole modules, with several. Pieces that are not
/// reached by `end_s` of the budget are left out and counted in the notes. `regions` belong to the original and may be
/// null.
[[nodiscard]] std::vector<WiredLayout> layouts_on_pieces(DesignInWork& work, const SearchedSurface& searched,
                                                         const mesh::SurfaceRegions* regions, double end_s);

}  // namespace triskin::pipeline
