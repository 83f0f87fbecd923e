// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <Eigen/Core>

#include "taxel_model.hpp"
#include "triskin/mechanics/inverse.hpp"

namespace triskin::mechanics {

/// Sets how much a search spends: kFull has many starts and samples the posterior; kStream starts at the strongest
/// taxel, stops when the remainder looks like the stated noise, and takes the deviations from the ridges of the
/// posterior.
enum class Effort { kFull, kStream };

/// Runs the search of find_contacts(); the options must be in range and the values finite.
[[nodiscard]] InverseResult search_contacts(const TaxelModel& model, const Eigen::VectorXd& observed,
                                            const InverseOptions& options, Effort effort);

}  // namespace triskin::mechanics
