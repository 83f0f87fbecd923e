// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <Eigen/Core>
#include <vector>

namespace triskin::mechanics {

struct DiscPoint {
  Eigen::Vector2d position;  // The unit is the radius of the disc.
  double weight;             // All weights add up to 1.
};

/// Returns points whose weighted sum is the mean over a disc: six Gauss rings in r² with sixteen points each, rotated
/// against each other.
[[nodiscard]] const std::vector<DiscPoint>& disc_points();

/// Returns a quarter of the points, for discs on which nothing bends sharply.
[[nodiscard]] const std::vector<DiscPoint>& coarse_disc_points();

}  // namespace triskin::mechanics
