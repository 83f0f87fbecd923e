// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <Eigen/Core>
#include <optional>
#include <vector>

#include "taxel_model.hpp"

namespace triskin::mechanics {

/// Weak knowledge about contacts before the taxels are looked at.
struct FitPriors {
  double position_sd_mm = 5.0;
  double log_force_sd = 2.0;
  double log_radius = 2.4849;  // This is ln 12 mm.
  double log_radius_sd = 1.0;
};

struct Fit {
  std::vector<FitContact> contacts;
  std::vector<FitContact> prior_centres;
  double noise = 0.0;
  Eigen::MatrixXd covariance;  // Covariance of the four parameters of each contact.
  double residual_sum = 0.0;   // Sum of squares, without priors.
  double objective = 0.0;      // (residual / noise)² and the priors
};

/// Levenberg-Marquardt from `start`; positions and forces of `prior_centres` are the centres of the priors. Nothing
/// where the start itself is impossible.
[[nodiscard]] std::optional<Fit> fit_contacts(const TaxelModel& model, const Eigen::VectorXd& observed,
                                              const std::vector<FitContact>& start,
                                              const std::vector<FitContact>& prior_centres, double noise,
                                              const FitPriors& priors);

/// Twice the negative logarithm of the posterior of `contacts`, but for a constant; infinite where they are impossible.
[[nodiscard]] double posterior_objective(const TaxelModel& model, const Eigen::VectorXd& observed,
                                         const std::vector<FitContact>& contacts,
                                         const std::vector<FitContact>& prior_centres, double noise,
                                         const FitPriors& priors);

}  // namespace triskin::mechanics
