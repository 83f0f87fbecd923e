// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <vector>

#include "net.hpp"
#include "triskin/base/dice.hpp"

namespace triskin::lattice {

/// A part of space in which one thread changes a net while others change the rest of it: an intersection of
/// half-spaces.
struct Zone {
  struct HalfSpace {
    Vec3 normal;
    double from_mm;  ///< The plane is at this distance from the origin along the normal.
  };
  std::vector<HalfSpace> sides;  ///< Without any half-space the zone is all of space.
  [[nodiscard]] bool holds(const Vec3& p) const {
    for (const HalfSpace& side : sides) {
      if (side.normal.dot(p) < side.from_mm) return false;
    }
    return true;
  }
};

/// Two zones are twice this far apart. Modules of two zones are 60 mm apart when they begin; those that touch are at
/// most 4h/3 = 34.6 mm apart, so both may slide by a third of a side.
inline constexpr double kHalfBand_mm = 30.0;

/// Divides a net into `count` ≥ 1 zones with about as many modules in each, by planes of random directions. Cost: O(n
/// log count).
[[nodiscard]] std::vector<Zone> divide(const LatticeMesh& net, int count, Dice& random);

/// Pins everything outside a zone (LatticeMesh::pin) and returns the triangles, ascending, without those that were
/// fixed before.
[[nodiscard]] std::vector<int> pin_outside(LatticeMesh& net, const Zone& zone);

/// Undoes pin_outside() for these triangles.
void unpin(LatticeMesh& net, const std::vector<int>& triangles);

/// A net that was changed in one zone only.
struct ZoneNet {
  const LatticeMesh& net;
  const std::vector<int>& pinned;  ///< pin_outside() returned these triangles.
};

/// Merges the changes of all zones into one net, begun from copies of one net; only what was fixed in that net is
/// pinned in it. Triangles keep their numbers if these are free. `empty` is a net without triangles that receives them.
/// If islands of two zones come to hold the same tile of one lattice, or modules of two zones slid within reach of each
/// other, that of the later zone is dropped. Cost: O(n log n).
[[nodiscard]] LatticeMesh merge_zones(LatticeMesh empty, const std::vector<ZoneNet>& zones);

}  // namespace triskin::lattice
