// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <Eigen/Core>
#include <vector>

#include "contact_fit.hpp"
#include "contact_ridge.hpp"

namespace triskin::mechanics {

/// Returns the moments of the posterior of each contact of a fit. If the objective grows along every principal axis as
/// the Gauss-Newton matrix predicts, the posterior is normal and the matrix gives the moments. Otherwise (few pressed
/// taxels) they come from samples of all contacts together by parallel tempering: mean and deviation, or, for a contact
/// that the matrix knows to 0.5 mm and a tenth of its force, the optimum and the deviation about it. If the samples
/// lead to a lower optimum, `fit` becomes that one. Deterministic. Cost: eight forward models a contact, or some
/// thousand.
[[nodiscard]] std::vector<ContactMoments> posterior_moments(const FitProblem& problem, Fit& fit);

}  // namespace triskin::mechanics
