// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <vector>

#include "body_mesh.hpp"
#include "triskin/cad/part.hpp"

namespace triskin::cad_reader {

[[nodiscard]] cad::SurfaceKind kind_of(const ExactFace& face);
/// Returns the radius of a cylinder, sphere or torus tube; 0 for other kinds.
[[nodiscard]] double radius_of(const ExactFace& face);
/// Returns the diameter of the round hole whose wall each face is, 0 if it is none. Faces of one axis and radius, such
/// as two half cylinders, are one wall. Cost: quadratic in the hollow cylinders and cones.
[[nodiscard]] std::vector<double> hole_diameters(const std::vector<ExactFace>& faces);

}  // namespace triskin::cad_reader
