// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "plan/lattice/src/net.hpp"

namespace triskin::lattice {

// Adds an island of one module in a horizontal plane, with these corners in tile order; returns its triangle.
inline int add_island(LatticeMesh& net, const std::array<Vec3, 3>& corners) {
  std::array<int, 3> v{};
  for (int k = 0; k < 3; ++k) {
    const auto [i, j] = tile_corner_index({}, k);
    v[at(k)] = net.add_vertex(corners[at(k)], Vec3::UnitZ(), i, j);
  }
  return net.add_triangle(net.new_island(), {}, v);
}

// Does the same on the lattice whose origin lies at a place.
inline int add_island(LatticeMesh& net, const Vec3& origin) {
  std::array<Vec3, 3> corners;
  for (int k = 0; k < 3; ++k) {
    const auto [i, j] = tile_corner_index({}, k);
    corners[at(k)] = origin + Vec3(kSide_mm * (i + 0.5 * j), kHeight_mm * j, 0);
  }
  return add_island(net, corners);
}

}  // namespace triskin::lattice
