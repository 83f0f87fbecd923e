// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "kernels/tile_polygon.hpp"

namespace triskin::placement {

/// Checks with exact predicates that every tile, shrunk by `tolerance_mm`, lies in the moved polygon: no edge meets its
/// interior and its centre is inside. Throws std::logic_error naming the tile: a wrong answer is never returned.
void require_exact(const PreparedPolygon& polygon, const Motion& motion, const std::vector<Tile>& tiles,
                   double tolerance_mm, const TileGrid& grid);

}  // namespace triskin::placement
