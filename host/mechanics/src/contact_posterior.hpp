// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <Eigen/Core>
#include <vector>

#include "contact_fit.hpp"
#include "contact_ridge.hpp"

namespace triskin::mechanics {

/// Returns the moments of the posterior of each contact of a fit. If the objective grows along every principal axis as
/// the Gauss-Newton matrix predicts, the posterior is normal and the matrix gives them; otherwise (few pressed taxels)
/// samples of all contacts together do, by the Metropolis-Hastings algorithm. Deterministic. Cost: eight forward models
/// per contact, or some 1,800 of them for each contact.
[[nodiscard]] std::vector<ContactMoments> posterior_moments(const FitProblem& problem, const Fit& fit);

/// Computes the same from the ridges alone, one contact at a time with the others as fitted: each cell of a ridge is a
/// normal distribution of known weight. Cost: some hundred forward models per contact.
[[nodiscard]] std::vector<ContactMoments> ridge_moments(const FitProblem& problem, const Fit& fit);

}  // namespace triskin::mechanics
