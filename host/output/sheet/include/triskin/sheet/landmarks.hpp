// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <array>
#include <string>
#include <vector>

#include "triskin/design/mesh.hpp"

namespace triskin::sheet {

/// A point of the part that can be found by eye, from which places are measured.
struct Landmark {
  std::string name;  ///< The name is R1, R2, … on a rim and S1, … on a part without one.
  design::Vec3 at_mm;
  std::string where;  ///< The text tells which point of which rim it is.
};

/// Finds landmarks of a surface. On every rim (closed chain of edges with one face) of at least 30 mm these are the
/// points farthest along ±x, ±y, ±z of the mesh frame; of those within 0.5 mm the one where the rim turns most.
/// Places nearer than 5 mm to an earlier one are left out. Without a rim the points of the whole surface are taken;
/// without vertices none. Cost: O(faces log faces).
[[nodiscard]] std::vector<Landmark> landmarks_of(const design::Mesh& surface);

/// Gives the position of a point by its straight distances from two landmarks, as calipers measure them.
struct Fix {
  std::array<int, 2> landmark{-1, -1};  ///< The indices refer to landmarks_of(); −1 means that there are fewer.
  std::array<double, 2> distance_mm{};
};
/// Returns the two nearest landmarks whose directions from the point differ by 30° to 150° (degrees), so that the two
/// distances meet at a point; without such a pair, the two nearest. Cost: O(landmarks²).
[[nodiscard]] Fix fix_of(const std::vector<Landmark>& landmarks, const design::Vec3& at_mm);

/// Returns the edges of a surface that belong to one face, as pairs of points, mm. Cost: O(faces log faces).
[[nodiscard]] std::vector<std::array<design::Vec3, 2>> rim_edges_of(const design::Mesh& surface);

/// Returns the straight distance from a point to the nearest point of `edges`, mm; −1 without edges. Cost: linear.
[[nodiscard]] double distance_to_mm(const std::vector<std::array<design::Vec3, 2>>& edges, const design::Vec3& at_mm);

}  // namespace triskin::sheet
