// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <Eigen/Core>
#include <span>

#include "contact_prior.hpp"
#include "taxel_model.hpp"

namespace triskin::mechanics {

/// Two rigid tips cannot press the same place, and displacements of contacts that overlap do not add up. These
/// functions return the square of the overlap of each pair of contacts over its deviation, and add it to a Gauss-Newton
/// matrix and to half of the gradient. Contacts that do not overlap add nothing.
[[nodiscard]] double overlap_objective(const FitPriors& priors, std::span<const FitContact> contacts,
                                       const TaxelResponse& response);
void add_overlap(const FitPriors& priors, std::span<const FitContact> contacts, const TaxelResponse& response,
                 Eigen::MatrixXd& matrix, Eigen::VectorXd& half_gradient);

}  // namespace triskin::mechanics
