// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <Eigen/Core>
#include <Eigen/Geometry>
#include <array>
#include <vector>

#include "triskin/base/format_index.hpp"
#include "triskin/layout/index.hpp"

namespace triskin::design {

using Vec2 = Eigen::Vector2d;  ///< Coordinates are in mm, in the plane of the grid or of a piece.
using Vec3 = Eigen::Vector3d;  ///< Coordinates are in mm, in the frame of the mesh.

/// Numbers a face of a mesh: the index in Mesh::faces. −1 stands for none, for example across the border.
using FaceIndex = layout::Index<struct FaceIndexTag>;
/// Numbers a vertex of a mesh: the index in Mesh::vertices. −1 stands for none.
using VertexIndex = layout::Index<struct VertexIndexTag>;
/// Numbers a face of a CAD part: the index in cad::Part::faces. Such a face of a boundary representation is a piece of
/// exact surface, for which many faces of a mesh stand. −1 stands for none.
using BrepFaceIndex = layout::Index<struct BrepFaceIndexTag>;

/// A mesh of a cover has triangles: vertices in mm (mesh frame), faces as vertex indices (0-based), counter-clockwise
/// seen from outside. The corners of faces stay plain integers because files and other libraries fill them; make a
/// VertexIndex of one before you pass it on. The struct checks nothing; mesh::Surface checks orientation and
/// manifoldness.
struct Mesh {
  std::vector<Vec3> vertices;
  std::vector<std::array<int, 3>> faces;
};

}  // namespace triskin::design
