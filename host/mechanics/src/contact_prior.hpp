// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <Eigen/Core>
#include <span>
#include <vector>

#include "taxel_model.hpp"

namespace triskin::mechanics {

/// Weak knowledge about a contact before the taxels are looked at. It does not depend on where a search starts, so
/// objectives of different starts can be compared.
struct FitPriors {
  double log_force = 0.0, log_force_sd = 2.0;
  double log_radius = 2.4849;  // This is ln 12 mm.
  double log_radius_sd = 1.0;
  // A contact lies where taxels are: no preference up to the first distance from the nearest one, normal beyond.
  double free_distance_mm = 2.0, distance_sd_mm = 4.0;
};

/// Priors of a layer: the force is about what presses a tip of 12 mm by a quarter of the thickness into columns.
[[nodiscard]] FitPriors priors_for(const Layer& layer);

/// Twice the negative logarithm of the prior density, but for a constant.
[[nodiscard]] double prior_objective(const FitPriors& priors, std::span<const Eigen::Vector2d> taxels_mm,
                                     std::span<const FitContact> contacts);

/// Adds the prior's share to a Gauss-Newton matrix and to half of the gradient.
void add_prior(const FitPriors& priors, std::span<const Eigen::Vector2d> taxels_mm,
               std::span<const FitContact> contacts, Eigen::MatrixXd& matrix, Eigen::VectorXd& half_gradient);

}  // namespace triskin::mechanics
