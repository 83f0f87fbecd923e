// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <Eigen/Core>
#include <span>
#include <vector>

#include "taxel_model.hpp"

namespace triskin::mechanics {

/// States weak knowledge about a contact before any taxel is read. It does not depend on where a search starts, so
/// objectives of different starts can be compared.
struct FitPriors {
  double log_force = 0.0, log_force_sd = 2.0;
  double log_radius = 2.4849;  // The median radius is 12 mm, stored as ln 12.
  double log_radius_sd = 1.0;
  // Contacts lie near taxels: there is no preference up to the first distance from the nearest one, and a normal
  // distribution beyond.
  double free_distance_mm = 2.0, distance_sd_mm = 4.0;
  double overlap_sd_mm = 0.4;  // Contacts do not overlap; their radii err by this much where the layer is superposed.
};

/// Returns the priors of a layer: the expected force presses a tip of 12 mm by a quarter of the thickness into columns.
[[nodiscard]] FitPriors priors_for(const Layer& layer);

/// Returns twice the negative logarithm of the prior density, up to a constant.
[[nodiscard]] double prior_objective(const FitPriors& priors, std::span<const Eigen::Vector2d> taxels_mm,
                                     std::span<const FitContact> contacts);

/// Adds the contribution of the prior to a Gauss-Newton matrix and to half of the gradient.
void add_prior(const FitPriors& priors, std::span<const Eigen::Vector2d> taxels_mm,
               std::span<const FitContact> contacts, Eigen::MatrixXd& matrix, Eigen::VectorXd& half_gradient);

}  // namespace triskin::mechanics
