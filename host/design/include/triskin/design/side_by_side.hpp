// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <Eigen/Geometry>
#include <span>
#include <vector>

#include "triskin/design/design.hpp"

namespace triskin::design {

/// One of several covers and where it lies.
struct PlacedCover {
  const Design* design = nullptr;
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();  ///< It takes the mesh frame into the common frame, in mm.
};

/// Ids of the modules, patches and islands of a cover in the joint design: its own plus these.
struct CoverOffset {
  int module = 0, patch = 0, island = 0;
};

/// Several covers as one design in a common frame, one after the other: for pictures, and for one simulated bus.
struct SideBySide {
  Design design;  ///< Its id is that of no file; pieces and alternatives are left out.
  std::vector<CoverOffset> offsets;
};
/// Joins `covers`, which outlive the call. Its node addresses are those of the covers. Throws InputError when corner
/// cuts differ. Cost: linear.
[[nodiscard]] SideBySide side_by_side(std::span<const PlacedCover> covers);

}  // namespace triskin::design
