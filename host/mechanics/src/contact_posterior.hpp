// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <Eigen/Core>
#include <vector>

#include "contact_fit.hpp"

namespace triskin::mechanics {

/// Means and standard deviations of x, y (mm), force (N) and radius (mm) of one contact.
struct ContactMoments {
  Eigen::Vector4d mean, deviation;
};

/// Moments of the posterior of each contact of a fit. Where the objective grows along every principal axis as the
/// Gauss-Newton matrix says, the posterior is normal and the matrix gives them; elsewhere (few pressed taxels) samples
/// of all contacts together do, by the Metropolis-Hastings algorithm. Deterministic. Cost: eight forward models a
/// contact, or some 1,800 of them for each contact.
[[nodiscard]] std::vector<ContactMoments> posterior_moments(const FitProblem& problem, const Fit& fit);

}  // namespace triskin::mechanics
