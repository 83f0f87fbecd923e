// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <Eigen/Core>
#include <vector>

#include "contact_fit.hpp"

namespace triskin::mechanics {

/// Gives means and standard deviations of x, y (mm), force (N) and radius (mm) of one contact.
struct ContactMoments {
  Eigen::Vector4d mean, deviation;
};

/// Returns the moments of the posterior of each contact, one at a time with the others as fitted. A blunt tip far away
/// and a sharp one near by explain few taxels alike, so the posterior is a long, bent ridge: for each tip radius there
/// is a best place and force, with their normal distribution about it. Each cell of equal width in ln R counts with
/// exp(-objective / 2) times the volume of that distribution. Cost: some hundred forward models per contact.
[[nodiscard]] std::vector<ContactMoments> ridge_moments(const FitProblem& problem, const Fit& fit);

}  // namespace triskin::mechanics
