// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <array>
#include <filesystem>
#include <optional>
#include <vector>

#include "triskin/mesh/mesh_io.hpp"
#include "triskin/mesh/surface.hpp"

namespace triskin::unfolding {

/// Coordinates are in mm.
using SeamLines = std::vector<std::vector<Vec3>>;

/// An edge of a surface, seen from one of its faces: the face and its side 0 … 2 (corner side → side + 1).
struct SurfaceEdge {
  FaceIndex face{0};
  int side = 0;
};

/// Reads polylines (mm after `unit`, default mm) of an OBJ file: `v x y z` and `l i j k …` (1-based; negative counts
/// from the end); other records are passed over. Errors: InputError naming file, line and remedy for a file that cannot
/// be read, for numbers that are none, indices without a vertex, lines of fewer than two points, and a file without
/// `l`. Appends warnings to `notes`, for example that the last line may have been cut.
[[nodiscard]] SeamLines read_seams(const std::filesystem::path& path, std::optional<mesh::LengthUnit> unit = {},
                                   std::vector<std::string>* notes = nullptr);

/// Returns the edges of the surface along the lines, for UnfoldingOptions::seams or ::uncut: each point moves to the
/// nearest vertex, and consecutive points are joined along edges by the shortest path. Errors: InputError naming
/// `name`, line and point if the nearest vertex is more than `within_mm` away, no path leads along edges, or a line
/// collapses to a single vertex. Cost: O(n log n) per point (Dijkstra).
[[nodiscard]] std::vector<SurfaceEdge> edges_along(const mesh::Surface& surface, const SeamLines& lines,
                                                   const std::string& name, double within_mm = 5.0);

}  // namespace triskin::unfolding
