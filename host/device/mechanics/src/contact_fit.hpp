// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <Eigen/Core>
#include <limits>
#include <optional>
#include <span>
#include <vector>

#include "contact_prior.hpp"
#include "taxel_model.hpp"

namespace triskin::mechanics {

struct Fit {
  std::vector<FitContact> contacts;
  double noise = 0.0;
  Eigen::MatrixXd precision;  // The Gauss-Newton matrix has four parameters per contact.
  double residual_sum = 0.0;  // The sum of squares does not include the priors.
  double objective = 0.0;     // The objective sums (residual / noise)² and the priors.
};

/// Returns a precision whose places have deviations of at most 2 mm. Around a single taxel the Gauss-Newton matrix does
/// not bound the place: the circle about the taxel bends away from it.
[[nodiscard]] Eigen::MatrixXd with_bounded_places(Eigen::MatrixXd precision);

/// Returns the inverse of a positive definite matrix.
[[nodiscard]] Eigen::MatrixXd covariance_of(const Eigen::MatrixXd& precision);

/// Returns twice the negative logarithm of the probability about an optimum (Laplace's approximation), up to a constant
/// that is equal for equal numbers of contacts: a broad optimum holds more than a narrow one that is a little lower.
[[nodiscard]] double evidence_objective(const Fit& fit);

/// A fit needs this model, the observations and the priors.
struct FitProblem {
  const TaxelModel& model;
  const Eigen::VectorXd& observed;
  double noise = 0.0;
  FitPriors priors;
};

/// Runs Levenberg-Marquardt from `start`, at most `max_steps` accepted steps; parameters in `frozen` stay. Returns
/// nothing if the start itself is impossible.
[[nodiscard]] std::optional<Fit> fit_contacts(const FitProblem& problem, const std::vector<FitContact>& start,
                                              int max_steps = 60, std::span<const Eigen::Index> frozen = {});

/// Twice the negative logarithm of the posterior, up to a constant, is the sum of two parts: how far the taxels are
/// from their values, and how unlikely the contacts are by themselves. Impossible contacts have an infinite misfit.
struct Objective {
  double misfit = std::numeric_limits<double>::infinity(), prior = 0.0;
  [[nodiscard]] double total() const { return misfit + prior; }
};
[[nodiscard]] Objective objective_of(const FitProblem& problem, std::span<const FitContact> contacts);

/// Returns twice the negative logarithm of the posterior of `contacts`, up to a constant; infinite if they are
/// impossible.
[[nodiscard]] double posterior_objective(const FitProblem& problem, std::span<const FitContact> contacts);

/// Converts between contacts and parameters, four per contact: x, y, ln F, ln R.
[[nodiscard]] Eigen::VectorXd parameters_of(std::span<const FitContact> contacts);
[[nodiscard]] std::vector<FitContact> contacts_from(const Eigen::VectorXd& parameters);

}  // namespace triskin::mechanics
