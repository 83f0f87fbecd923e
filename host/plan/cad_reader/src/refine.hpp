// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "body_mesh.hpp"

namespace triskin::cad_reader {

/// Divides triangles at the exact surface until the distance between each and its surface, measured at the middles of
/// the sides and of the triangle and both ways, is at most `max_deviation_mm`. Neighbours stay joined. Ends after a
/// bounded number of rounds and triangles. Sets the deviation of every face and its place.
void refine(BodyMesh& mesh, double max_deviation_mm);

}  // namespace triskin::cad_reader
