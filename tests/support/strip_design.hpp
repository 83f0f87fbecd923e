// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "support/flat_design.hpp"
#include "triskin/design/module_number.hpp"

namespace triskin::test {

/// Makes a straight strip of `count` modules on the plane z = 0, divided into patches of `per_patch`; in a patch module
/// k has line k / 4 and address k % 4, and its parent is module k - 1.
inline design::Design strip(int count, int per_patch = 16) {
  using design::kHeight_mm;
  using design::Vec3;
  design::Design d = flat_design("strip", {-1, -1}, {1000, 30});
  for (int k = 0; k < count; ++k) {
    const double x = 30.0 * (k / 2);
    design::PlacedModule m;
    m.tile = {k / 2, 0, k % 2 == 0};
    // Tile corners and sides are as in tile.hpp; side 1 of an up tile is side 2 of the down tile with the same (i, j).
    if (m.tile.up) {
      m.corner_mm = {Vec3{x, 0, 0}, Vec3{x + 30, 0, 0}, Vec3{x + 15, kHeight_mm, 0}};
      m.neighbour = {-1, k + 1 < count ? k + 1 : -1, k - 1};
    } else {
      m.corner_mm = {Vec3{x + 30, 0, 0}, Vec3{x + 45, kHeight_mm, 0}, Vec3{x + 15, kHeight_mm, 0}};
      m.neighbour = {k + 1 < count ? k + 1 : -1, -1, k - 1};
    }
    d.layout.modules.push_back(m);
  }
  for (int first = 0; first < count; first += per_patch) {
    design::Patch patch;
    patch.entry = first;
    for (int k = first; k < std::min(count, first + per_patch); ++k) {
      const int n = k - first;
      // Port A (side `rotation`) faces the parent, which lies across side 2.
      patch.modules.push_back({k, n == 0 ? -1 : k - 1, 2, n / 4, n % 4, n});
    }
    patch.max_depth = static_cast<int>(patch.modules.size()) - 1;
    d.patches.push_back(patch);
  }
  d.design_id = design::design_id_of(d);
  return d;
}

/// Gives modules and controllers numbers as after the removal of others: modules 0 … 4, 12 … 36 (ids 5 … 29) and
/// on from 50 (ids from 30), controllers 0, 2, 3 ….
inline design::Design with_gaps(design::Design d) {
  std::vector<int> numbers;
  for (int id = 0; id < static_cast<int>(d.layout.modules.size()); ++id)
    numbers.push_back(id < 5 ? id : id < 30 ? id + 7 : id + 20);
  design::set_numbers(d.layout, std::move(numbers));
  if (d.patches.size() > 1) d.patches.insert(d.patches.begin() + 1, design::Patch{});
  d.design_id = design::design_id_of(d);
  return d;
}

}  // namespace triskin::test
