// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <optional>
#include <utility>
#include <vector>

#include "triskin/geometry/extract.hpp"

namespace triskin::geometry {

/// Cosine-weighted share of the sky that each of these faces sees above its front and its back (directions that
/// repeat). Cost: 2 · 64 rays a face asked, on all cores.
struct Sky {
  double front = 0.0, back = 0.0;
};
[[nodiscard]] std::vector<Sky> sky_of(const Mesh& mesh, const std::vector<int>& faces);

/// The same of all faces in about `cpu_s` > 0 seconds of processor time, at least 0.5 s: of a mesh with too many faces
/// for that, neighbours that face much the same way share the answer of one of them. Depends on no clock.
[[nodiscard]] std::vector<Sky> sky_of_all(const Mesh& mesh, double cpu_s);

/// Parts that see more with their back are turned; faces that see less than the fraction go, ragged rims evened out.
/// Cost: sky_of_all().
[[nodiscard]] Mesh outer_faces(const Mesh& mesh, double sky_fraction, double cpu_s);

/// Share of ExtractOptions::repair_s that one look at the sky of all faces may take: up to three are taken.
inline constexpr double kSkyTimeShare = 0.12;

/// Closed surface around the mesh (CGAL's alpha wrap), made in a child process; nothing when that needs more than
/// `cpu_s` seconds of processor time, or fails.
[[nodiscard]] std::optional<Mesh> wrapped(const Mesh& mesh, double alpha_mm, double offset_mm, unsigned cpu_s);

/// Closed surface at 0.9 cells around any triangles by marching tetrahedra on a grid: a manifold that does not cross
/// itself, always. What is enclosed is not part of it. Cost: one distance a node near the mesh, 5 bytes a node.
[[nodiscard]] Mesh grid_wrapped(const Mesh& mesh, double cell_mm);

/// The mesh with the faces of these pairs divided along their common lines, so that they meet in whole edges (exact
/// constructions; coordinates are rounded at the end). Corners of faces keep their numbers and come first.
[[nodiscard]] Mesh arranged(const Mesh& mesh, const std::vector<std::pair<int, int>>& crossings);

/// Pairs of faces that pass through or touch each other beyond a common edge or corner, by exact predicates. The mesh
/// is a manifold. Sorted. Cost: O(n log n) typical.
[[nodiscard]] std::vector<std::pair<int, int>> crossing_faces(const Mesh& mesh);

/// Distances both ways between the outside faces of the input and all of the result; largest_mm is a proved bound.
/// Equal triangles of both count as 0 without a search. Cost: up to 4,000 closest-point searches a changed face.
[[nodiscard]] Deviation deviation_between(const Mesh& input, const std::vector<bool>& outside, const Mesh& result);

/// Each face with vertices of its own, so that any triangles make a Surface to measure distances to.
[[nodiscard]] Mesh unshared(const Mesh& mesh);

/// Repair of the topology alone, the first step of extract(). Errors: InputError when no part is as large as a module.
[[nodiscard]] Extraction joined(const Mesh& mesh);

/// Makes what design() takes: moves corners apart that only touch, then drops faces that still cross, until none does.
/// Errors: InputError when nothing is left. Cost: a search for crossings a round; each round drops a face.
[[nodiscard]] Extraction settled(const Mesh& mesh);

/// Repairs so that usable() holds; fills the report's repair and deviation.
/// Errors: InputError when no part as large as a module can be made.
[[nodiscard]] Extraction repaired(const Mesh& mesh, const ExtractOptions& options, const ProgressSink& progress);

/// Divides the faces at the border of the keep-outs and takes away what lies in them.
[[nodiscard]] Mesh without_keep_outs(const Mesh& mesh, const ExtractOptions& options);

[[nodiscard]] double area_of(const Mesh& mesh);

}  // namespace triskin::geometry
