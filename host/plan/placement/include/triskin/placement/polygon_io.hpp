// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "triskin/design/design_types.hpp"

namespace triskin::placement {

/// Reads one polygon in mm, holes allowed: GeoJSON (Polygon, MultiPolygon of one, Feature or collection of one) or WKT
/// (POLYGON, MULTIPOLYGON of one; Z and M are ignored, SRID is skipped). The result is normalized. Errors: InputError
/// naming file, ring and vertex if the polygon is invalid by OGC 06-103r4 (rings that cross or touch themselves, rings
/// that cross or share an edge, holes outside the outer ring or in each other, an inside in several parts), for an
/// empty or open ring, a key that occurs twice, and a file that cannot be read. Thread-safe.
[[nodiscard]] Polygon read_polygon(const std::filesystem::path& path);

/// Reads the same from text; messages use `name` in place of the file. Errors: InputError as read_polygon.
[[nodiscard]] Polygon parse_polygon(const std::string& text, const std::string& name);

struct Outlines {
  std::vector<Polygon> polygons;
  std::string remark;  ///< what a person has to know, as that a drawing names no unit; else empty
};
/// Reads the outlines of the pieces of a net as `triskin unfold` writes it (docs/unfolding.md), in its order; a file
/// with one polygon, or a drawing in DXF or SVG, gives that polygon. `unit_mm`: that of the numbers, whatever the file
/// says. Errors: InputError as read_polygon, for a net without pieces or with `unit_mm`, and for degrees of a map.
[[nodiscard]] Outlines read_polygons(const std::filesystem::path& path, std::optional<double> unit_mm = std::nullopt);
/// Reads the same from text; messages use `name` in place of the file. Errors: InputError as read_polygons.
[[nodiscard]] Outlines parse_polygons(const std::string& text, const std::string& name,
                                      std::optional<double> unit_mm = std::nullopt);

/// Returns true if two edges of the polygon cross in their interiors, decided exactly. Unlike the readers it does not
/// excuse edges that cross by no more than 1e-9 mm as touching. Cost: O(n log n) typical.
[[nodiscard]] bool crosses_itself(const Polygon& polygon);

/// Drops closing and repeated vertices, orients the outer ring counter-clockwise and holes clockwise. Edges of one
/// polygon may touch (a crack of zero width is a cut; edges that cross by no more than 1e-9 mm, or by the rounding of
/// their coordinates, touch), but not cross. Errors: InputError naming `name`, ring and vertex for rings of fewer than
/// three points, zero area, coordinates that are not finite or beyond ±1e8 mm, rings that cross, and holes outside the
/// outer ring. Cost: O(n log n) for typical outlines, O(n²) at worst.
[[nodiscard]] Polygon normalize_polygon(Polygon polygon, const std::string& name);

/// Returns the signed area of an open ring in mm² (counter-clockwise positive); 0 for fewer than three points. Cost:
/// O(n).
[[nodiscard]] double ring_area(const std::vector<Vec2>& ring);
/// Returns the area of a normalized polygon less its holes, in mm². Cost: O(n).
[[nodiscard]] double polygon_area(const Polygon& polygon);

}  // namespace triskin::placement
