// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <Eigen/Core>
#include <vector>

namespace triskin::mechanics {

struct DiscPoint {
  Eigen::Vector2d position;  // Position in radii of the disc.
  double weight;             // All weights add up to 1.
};

/// Points whose weighted sum is the mean over a disc: six rings of Gauss in r² with sixteen points each, turned
/// against each other.
[[nodiscard]] const std::vector<DiscPoint>& disc_points();

/// A quarter of the points, for discs on which nothing bends sharply.
[[nodiscard]] const std::vector<DiscPoint>& coarse_disc_points();

}  // namespace triskin::mechanics
