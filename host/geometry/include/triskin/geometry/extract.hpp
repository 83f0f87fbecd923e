// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <string>

#include "triskin/geometry/types.hpp"
#include "triskin/host/progress.hpp"

namespace triskin::geometry {

/// What making a surface from a raw mesh changed.
struct ExtractReport {
  int removed_components = 0;   ///< small or hidden parts
  int removed_faces = 0;        ///< faces at edges with more than two faces, hidden faces
  int flipped_faces = 0;
  int boundary_loops = 0;
};

struct Extraction {
  Mesh surface;  ///< manifold, oriented outwards where a side can be told
  ExtractReport report;
};

/// Makes a manifold, consistently oriented surface of a welded mesh: drops faces beyond two at an edge (the ones that turn
/// most), orients each component over its edges (a Möbius band is cut), splits pinched vertices, and drops components smaller
/// than a module. Throws InputError when nothing is left. Cost: O(n log n).
[[nodiscard]] Extraction extract(const Mesh& mesh, const ProgressSink& progress = {});

/// Throws InputError naming `name` and the place when an edge of the mesh has more than two faces (non-manifold).
void require_manifold(const Mesh& mesh, const std::string& name);

/// Throws InputError naming `name` and the place when two faces of the surface pass through each other. Exact predicates;
/// cost O(n log n) typical.
void require_no_self_intersection(const Mesh& surface, const std::string& name);

}  // namespace triskin::geometry
