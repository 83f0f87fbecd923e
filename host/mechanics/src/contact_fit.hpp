// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <Eigen/Core>
#include <optional>
#include <span>
#include <vector>

#include "contact_prior.hpp"
#include "taxel_model.hpp"

namespace triskin::mechanics {

struct Fit {
  std::vector<FitContact> contacts;
  double noise = 0.0;
  Eigen::MatrixXd precision;  // Gauss-Newton matrix of the four parameters of each contact
  double residual_sum = 0.0;  // Sum of squares, without priors.
  double objective = 0.0;     // It is (residual / noise)² and the priors.
};

/// What a fit is made to.
struct FitProblem {
  const TaxelModel& model;
  const Eigen::VectorXd& observed;
  double noise = 0.0;
  FitPriors priors;
};

/// Levenberg-Marquardt from `start`, at most `max_steps` accepted steps; parameters in `frozen` stay. Nothing where the
/// start itself is impossible.
[[nodiscard]] std::optional<Fit> fit_contacts(const FitProblem& problem, const std::vector<FitContact>& start,
                                              int max_steps = 60, std::span<const Eigen::Index> frozen = {});

/// Twice the negative logarithm of the posterior of `contacts`, but for a constant; infinite where they are impossible.
[[nodiscard]] double posterior_objective(const FitProblem& problem, std::span<const FitContact> contacts);

/// Four parameters a contact: x, y, ln F, ln R; and back.
[[nodiscard]] Eigen::VectorXd parameters_of(std::span<const FitContact> contacts);
[[nodiscard]] std::vector<FitContact> contacts_from(const Eigen::VectorXd& parameters);

}  // namespace triskin::mechanics
