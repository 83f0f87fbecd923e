// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <Eigen/Core>
#include <cstddef>

#include "contact_fit.hpp"

namespace triskin::mechanics {

/// A contact has four parameters: x, y, ln F, ln R.
using ContactVector = Eigen::Vector4d;

/// Gives means and standard deviations of x, y (mm), force (N) and radius (mm) of one contact.
struct ContactMoments {
  Eigen::Vector4d mean, deviation;
};

/// Returns the moments of the posterior of one contact, with the others as fitted. A blunt tip far away and a sharp one
/// near by explain few taxels alike, so the posterior is a long, bent ridge: for each tip radius there is a best place
/// and force, with their normal distribution about it. Each cell of equal width in ln R counts with
/// exp(-objective / 2) times the volume of that distribution. Cost: some hundred forward models.
[[nodiscard]] ContactMoments moments_along_ridge(const FitProblem& problem, const Fit& fit, std::size_t contact);

}  // namespace triskin::mechanics
