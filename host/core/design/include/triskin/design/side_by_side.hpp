// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <Eigen/Geometry>
#include <span>
#include <vector>

#include "triskin/design/design.hpp"

namespace triskin::design {

/// Each of several covers has its own pose.
struct PlacedCover {
  const Design* design = nullptr;
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();  ///< The pose maps the mesh frame to the common frame, in mm.
};

/// Several covers are joined into one design in a common frame, for pictures and for one simulated bus.
struct SideBySide {
  Design design;  ///< The id belongs to no file; pieces and alternatives are left out. It names its covers.
  std::vector<CoverOffset> offsets;
};
/// Joins `covers`, which must outlive the call. The result keeps the node addresses of the covers and the numbers of
/// their modules, which several covers have alike: the functions from a number to a module are of no use with it.
/// Throws InputError when corner cuts differ. Cost: linear.
[[nodiscard]] SideBySide side_by_side(std::span<const PlacedCover> covers);

}  // namespace triskin::design
