// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <Eigen/Core>
#include <optional>

#include "contact_fit.hpp"

namespace triskin::mechanics {

/// Means and standard deviations of x, y (mm), force (N) and radius (mm) of one contact.
struct ContactMoments {
  Eigen::Vector4d mean, deviation;
};

/// Moments of the posterior of one contact, the others as fitted: importance sampling about the fit, since few taxels
/// bend the posterior far from the normal distribution that the Gauss-Newton matrix describes. Nothing when too few
/// samples carry the weight. Deterministic. Cost: some hundred forward models.
[[nodiscard]] std::optional<ContactMoments> sample_posterior(const TaxelModel& model, const Eigen::VectorXd& observed,
                                                             const Fit& fit, std::size_t contact,
                                                             const FitPriors& priors);

}  // namespace triskin::mechanics
