// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <Eigen/Core>
#include <vector>

#include "taxel_model.hpp"

namespace triskin::mechanics {

struct ForceGuess {
  Eigen::Vector2d position_mm;
  double force_n = 0.0;
};

/// Returns contacts that a non-negative least-squares fit suggests; the one that explains most comes first. A taxel
/// whose capacitance changes less than `signal_floor` does not count as pressed.
[[nodiscard]] std::vector<ForceGuess> guess_contacts(const TaxelModel& model, const Eigen::VectorXd& observed,
                                                     double signal_floor);

/// Guesses one contact about the strongest value in two ways: at the centroid of the displacements around it, and at
/// the taxel itself. Forces follow from ∫ u dA = F·h/K. Returns nothing if no value is positive.
[[nodiscard]] std::vector<ForceGuess> guess_peak(const TaxelModel& model, const Eigen::VectorXd& observed);

}  // namespace triskin::mechanics
