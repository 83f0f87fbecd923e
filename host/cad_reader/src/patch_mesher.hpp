// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "body_mesh.hpp"
#include "edge_nodes.hpp"

namespace triskin::cad_reader {

/// Meshes one face where the kernel's mesher gives nothing or the wrong thing: the face's wires, divided as the
/// neighbouring faces have them, bound a constrained Delaunay triangulation in the parameters of the surface. A wire
/// that jumps in the parameters without an edge (through the tip of a cone) is closed by a straight line there, whose
/// nodes are one corner. Triangles are appended to `mesh`; refine() brings them to the surface. False where the wires
/// bound nothing; then nothing was appended.
[[nodiscard]] bool mesh_patch(BodyMesh& mesh, int face, EdgeNodes& nodes, double deflection_mm);

}  // namespace triskin::cad_reader
