// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <Eigen/Core>

#include "taxel_model.hpp"
#include "triskin/mechanics/inverse.hpp"

namespace triskin::mechanics {

/// How much a search spends: kFull starts in many ways and samples the posterior; kStream starts at the strongest
/// taxel, stops when what is left looks like the stated noise, and takes the deviations from the ridges of the
/// posterior.
enum class Effort { kFull, kStream };

/// The search behind find_contacts(); the options are in range and the values finite.
[[nodiscard]] InverseResult search_contacts(const TaxelModel& model, const Eigen::VectorXd& observed,
                                            const InverseOptions& options, Effort effort);

}  // namespace triskin::mechanics
