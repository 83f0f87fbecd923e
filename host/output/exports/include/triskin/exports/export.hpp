// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <string>

#include "triskin/design/design.hpp"

namespace triskin::exports {

/// Draws a design as SVG: the surface from the side that shows most modules and from as many of the other five as show
/// the number of a module that those before do not; modules coloured by patch, and the tree of each patch as lines from
/// the entry (dot). Errors: none for a design that was read or made. Cost: O(faces + modules).
[[nodiscard]] std::string picture_svg(const design::Design& design);

/// Lists the taxels as CSV, one row each: cover, module, taxel, patch, line, address, position (mm) and outward unit
/// normal in the frame of the design. Of a joint design the rows have the numbers of their covers. Modules without a
/// patch have −1 as patch. Cost: O(modules).
[[nodiscard]] std::string taxels_csv(const design::Design& design);

/// Exports modules as a mesh (OBJ, mm, mesh frame) named as the design (ascii_name), with one face per module, which is
/// in the groups of its name and of its patch (`module_19`, `patch_2`; of a robot `upperarm_module_19`). Cost:
/// O(modules).
[[nodiscard]] std::string modules_obj(const design::Design& design);

/// A module has its own frame in the mesh frame: x along side 0 (from corner 0 to corner 1), z outward, origin at the
/// centroid.
struct ModulePose {
  design::Vec3 origin_mm;
  Eigen::Matrix3d axes;  ///< The columns x, y and z are unit vectors in the mesh frame.
};
/// Returns the frame of `module` (docs/exports.md). Cost: constant.
[[nodiscard]] ModulePose frame_of(const design::PlacedModule& module);

/// Exports cover, modules and taxels as a scene (glTF 2.0, JSON with embedded data; metres, axes of the mesh frame).
/// Nodes have names, and "extras" with their wiring. Throws InputError for a design without surface. Cost: O(faces +
/// modules).
[[nodiscard]] std::string gltf(const design::Design& design);

/// What a robot's model says of a cover beside its modules.
struct CoverBody {
  std::string prefix;    ///< before all names of URDF, so that two covers fit one robot
  double mass_kg = 0.0;  ///< of cover, boards and cables, spread evenly over the surface; 0: not said
  std::string mesh_uri;  ///< where the reader finds cover_stl(); empty: none
};
/// Exports URDF (m, rad): a link skin_NAME, the frame of bridge and recordings; fixed to it a link "cover" with mesh
/// and mass; to that a link for each module in its frame, a plate for eye and contact; and the table of taxels. Throws
/// InputError for a mass or mesh of a design without surface. Cost: O(modules + faces).
[[nodiscard]] std::string urdf(const design::Design& design, const CoverBody& body = {});

/// Exports a model (SDFormat 1.7; m, rad), static without a mass, with the same frames, mesh, mass and plates. Throws
/// as urdf(). Cost: O(modules + faces).
[[nodiscard]] std::string sdf(const design::Design& design, const CoverBody& body = {});

/// Exports the surface as binary STL, in m, frame of the mesh. Throws InputError for a design without surface. Cost:
/// O(faces).
[[nodiscard]] std::string cover_stl(const design::Design& design);

}  // namespace triskin::exports
