// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "body_mesh.hpp"
#include "edge_nodes.hpp"

namespace triskin::cad_reader {

/// Meshes one face for which the kernel's mesher gives nothing or a wrong result: the face's wires, divided as in the
/// neighbouring faces, bound a constrained Delaunay triangulation in the parameters of the surface. A wire that jumps
/// in the parameters without an edge (through the tip of a cone) is closed by a straight line there, whose nodes are
/// one corner. Triangles are appended to `mesh`; refine() moves them to the surface. Returns false if the wires bound
/// nothing; then nothing was appended.
[[nodiscard]] bool mesh_patch(BodyMesh& mesh, int face, EdgeNodes& nodes, double deflection_mm);

}  // namespace triskin::cad_reader
