// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <string>

#include "triskin/design/polygon.hpp"

namespace triskin::placement {

/// Throws InputError naming `name`, rings and vertices (as they are counted in `polygon`) unless the polygon is valid
/// as OGC 06-103r4, 6.1.11.1 defines it, which is what GEOS, PostGIS and shapely test: no ring crosses or touches
/// itself, two rings do not cross and share no more than points, holes lie inside the outer ring and not in each other,
/// and the remaining interior is connected. Rings are open and have no point twice in a row. Exact. Cost: O(n log n)
/// for typical outlines, O(n²) at worst.
void require_valid_polygon(const design::Polygon& polygon, const std::string& name);

}  // namespace triskin::placement
