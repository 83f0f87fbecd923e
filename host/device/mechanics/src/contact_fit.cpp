// SPDX-License-Identifier: GPL-3.0-or-later
#include "contact_fit.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "contact_overlap.hpp"

namespace triskin::mechanics {
namespace {

constexpr double kMaxDamping = 1e8;
constexpr double kMaxPlaceDeviation_mm = 2.0;
constexpr double kMaxMove_mm = 3.0, kMaxLogMove = 0.7;

Eigen::VectorXd limited(Eigen::VectorXd step) {
  double longest = 0.0;
  for (Eigen::Index i = 0; i < step.size(); ++i)
    longest = std::max(longest, std::abs(step[i]) / (i % kParametersPerContact < 2 ? kMaxMove_mm : kMaxLogMove));
  return longest > 1.0 ? Eigen::VectorXd(step / longest) : step;
}

double prior_of(const FitProblem& problem, std::span<const FitContact> contacts, const TaxelResponse& response) {
  return prior_objective(problem.priors, problem.model.positions_mm(), contacts) +
         overlap_objective(problem.priors, contacts, response);
}

class Search {
 public:
  Search(const FitProblem& problem, std::span<const Eigen::Index> frozen) : problem_(problem), frozen_(frozen) {}

  // Moves to the place if it is possible and better than the current one.
  bool look_at(const Eigen::VectorXd& place) {
    const std::vector<FitContact> contacts = contacts_from(place);
    auto response = problem_.model.respond(contacts, true);
    if (!response) return false;
    const Eigen::VectorXd residual = response->values - problem_.observed;
    const double objective = residual.squaredNorm() * weight() + prior_of(problem_, contacts, *response);
    if (!(objective < objective_)) return false;
    at_ = place;
    objective_ = objective;
    residual_ = residual;
    response_ = *std::move(response);
    return true;
  }
  // Makes one accepted step; returns false when there is no better place.
  bool improve() {
    const auto [matrix, half_gradient] = normal_equations();
    while (damping_ < kMaxDamping) {
      Eigen::MatrixXd damped = matrix;
      damped.diagonal() *= 1.0 + damping_;
      const Eigen::VectorXd step = limited(-damped.ldlt().solve(half_gradient));
      const double before = objective_;
      if (look_at(at_ + step)) {
        damping_ = std::max(1e-9, damping_ / 5.0);
        return before - objective_ > 1e-7 * (1.0 + objective_);
      }
      damping_ *= 4.0;
    }
    return false;
  }
  [[nodiscard]] Fit result() const {
    return {contacts_from(at_), problem_.noise, normal_equations().first, residual_.squaredNorm(), objective_};
  }

 private:
  [[nodiscard]] double weight() const { return 1.0 / (problem_.noise * problem_.noise); }
  [[nodiscard]] std::pair<Eigen::MatrixXd, Eigen::VectorXd> normal_equations() const {
    const Eigen::MatrixXd& slopes = response_.derivatives;
    Eigen::MatrixXd matrix = slopes.transpose() * slopes * weight();
    Eigen::VectorXd half_gradient = slopes.transpose() * residual_ * weight();
    const std::vector<FitContact> contacts = contacts_from(at_);
    add_prior(problem_.priors, problem_.model.positions_mm(), contacts, matrix, half_gradient);
    add_overlap(problem_.priors, contacts, response_, matrix, half_gradient);
    for (const Eigen::Index k : frozen_) {
      matrix.row(k).setZero();
      matrix.col(k).setZero();
      matrix(k, k) = 1.0;
      half_gradient[k] = 0.0;
    }
    return {std::move(matrix), std::move(half_gradient)};
  }

  const FitProblem& problem_;
  std::span<const Eigen::Index> frozen_;
  double damping_ = 1e-3;
  double objective_ = std::numeric_limits<double>::infinity();
  Eigen::VectorXd at_, residual_;
  TaxelResponse response_;
};

}  // namespace

Eigen::VectorXd parameters_of(std::span<const FitContact> contacts) {
  Eigen::VectorXd all(static_cast<Eigen::Index>(kParametersPerContact * contacts.size()));
  Eigen::Index at = 0;
  for (const FitContact& c : contacts) {
    all.segment<4>(at) << c.position_mm, c.log_force, c.log_radius;
    at += kParametersPerContact;
  }
  return all;
}

std::vector<FitContact> contacts_from(const Eigen::VectorXd& parameters) {
  std::vector<FitContact> contacts;
  for (Eigen::Index i = 0; i < parameters.size(); i += kParametersPerContact)
    contacts.push_back({parameters.segment<2>(i), parameters[i + 2], parameters[i + 3]});
  return contacts;
}

std::optional<Fit> fit_contacts(const FitProblem& problem, const std::vector<FitContact>& start, int max_steps,
                                std::span<const Eigen::Index> frozen) {
  Search search(problem, frozen);
  if (!search.look_at(parameters_of(start))) return std::nullopt;
  for (int step = 0; step < max_steps && search.improve(); ++step) {
  }
  return search.result();
}

Eigen::MatrixXd with_bounded_places(Eigen::MatrixXd precision) {
  for (Eigen::Index k = 0; k < precision.rows(); k += kParametersPerContact)
    precision.diagonal().segment<2>(k).array() += 1.0 / (kMaxPlaceDeviation_mm * kMaxPlaceDeviation_mm);
  return precision;
}

Eigen::MatrixXd covariance_of(const Eigen::MatrixXd& precision) {
  return precision.ldlt().solve(Eigen::MatrixXd::Identity(precision.rows(), precision.cols()));
}

double evidence_objective(const Fit& fit) {
  const Eigen::VectorXd squares = with_bounded_places(fit.precision).ldlt().vectorD();
  return fit.objective + squares.array().max(std::numeric_limits<double>::min()).log().sum();
}

Objective objective_of(const FitProblem& problem, std::span<const FitContact> contacts) {
  const auto response = problem.model.respond(contacts, false);
  if (!response) return {};
  const double misfit = (response->values - problem.observed).squaredNorm() / (problem.noise * problem.noise);
  return {misfit, prior_of(problem, contacts, *response)};
}

double posterior_objective(const FitProblem& problem, std::span<const FitContact> contacts) {
  return objective_of(problem, contacts).total();
}

}  // namespace triskin::mechanics
