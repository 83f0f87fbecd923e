// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <Eigen/Core>
#include <Eigen/Geometry>
#include <array>
#include <vector>

namespace triskin::design {

using Vec2 = Eigen::Vector2d;  ///< Coordinates are in mm, in the plane of the grid or of a piece.
using Vec3 = Eigen::Vector3d;  ///< Coordinates are in mm, in the frame of the mesh.

/// A mesh of a cover has triangles: vertices in mm (mesh frame), faces as vertex indices (0-based), counter-clockwise
/// seen from outside. The struct checks nothing; geometry::Surface checks orientation and manifoldness.
struct Mesh {
  std::vector<Vec3> vertices;
  std::vector<std::array<int, 3>> faces;
};

}  // namespace triskin::design
