// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <string>

#include "triskin/mesh/mesh_io.hpp"

namespace triskin::mesh {

/// Returns the diagonal of the bounding box in mm; 0 without vertices.
[[nodiscard]] double diagonal_of(const Mesh& mesh);

/// Tells whether vertices at the same place become one. A CAD part has its corners joined already, and bodies that
/// touch must not be joined.
enum class Corners { kWelded, kKept };

/// Welds vertices at the same place (on a grid of 1e-7 of the size), drops faces without area, double faces and unused
/// vertices, and joins seams and T-junctions within 2e-7 of the size, as reading a file does. Adds what it did to the
/// report. Cost: O(n log n).
void clean(Mesh& mesh, MeshReadReport& report, Corners corners = Corners::kWelded);

/// Writes a mesh as bytes for the answer of run_isolated(); mesh_of() reads them back. No file has this format.
[[nodiscard]] std::string bytes_of(const Mesh& mesh);
[[nodiscard]] Mesh mesh_of(const std::string& bytes);

/// Removes vertices that no face uses; the others keep the order in which the faces name them. Cost: O(n).
void drop_unused_vertices(Mesh& mesh);

}  // namespace triskin::mesh
