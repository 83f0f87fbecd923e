// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <vector>

#include "body_mesh.hpp"
#include "triskin/cad/part.hpp"

namespace triskin::cad_reader {

/// Kind of the surface under a face.
[[nodiscard]] cad::SurfaceKind kind_of(const ExactFace& face);
/// Radius of a cylinder, sphere or torus tube; 0 for other kinds.
[[nodiscard]] double radius_of(const ExactFace& face);
/// Diameter of the round hole whose wall each face is, 0 where it is none. Faces of one axis and radius, such as two
/// half cylinders, are one wall. Cost: quadratic in the cylinders and cones that are hollow.
[[nodiscard]] std::vector<double> hole_diameters(const std::vector<ExactFace>& faces);

}  // namespace triskin::cad_reader
