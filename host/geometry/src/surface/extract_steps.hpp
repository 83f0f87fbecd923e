// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <vector>

#include "triskin/geometry/extract.hpp"

namespace triskin::geometry {

/// Cosine-weighted share of the sky that each face sees above its front and its back (directions that repeat). Cost:
/// 2 · 64 rays a face, on all cores.
struct Sky {
  double front = 0.0, back = 0.0;
};
[[nodiscard]] std::vector<Sky> sky_of(const Mesh& mesh);

/// Parts that see more with their back are turned; faces that see less than the fraction go, ragged rims evened out.
[[nodiscard]] Mesh outer_faces(const Mesh& mesh, double sky_fraction);

/// Closed surface around the mesh (CGAL's alpha wrap).
[[nodiscard]] Mesh wrapped(const Mesh& mesh, double alpha_mm, double offset_mm);

/// Divides the faces at the border of the keep-outs and takes away what lies in them.
[[nodiscard]] Mesh without_keep_outs(const Mesh& mesh, const ExtractOptions& options);

[[nodiscard]] double area_of(const Mesh& mesh);

}  // namespace triskin::geometry
