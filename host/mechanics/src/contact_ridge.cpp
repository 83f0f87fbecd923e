// SPDX-License-Identifier: GPL-3.0-or-later
#include "contact_ridge.hpp"

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

namespace triskin::mechanics {
namespace {

// Width of a cell: a share of the fit's deviation of ln R, bounded for radii that the fit hardly knows.
constexpr double kWidthShare = 0.6, kMaxWidth = 0.25, kMinWidth = 1e-5;
constexpr int kMaxCells = 24, kFollowSteps = 6;
// The ridge ends where the density has fallen to exp(−8).
constexpr double kMaxRise = 16.0;
// Draws are wider than the normal distribution, and some are much wider, so that tails are covered.
constexpr double kWidening = 1.2, kFarWidening = 3.0, kFarShare = 0.2;

double log_determinant(const Eigen::Matrix3d& root) {
  return root.diagonal().array().log().sum();
}

// Root of the covariance of place and force at a given radius.
Eigen::Matrix3d place_root(const Fit& fit, Eigen::Index at) {
  const Eigen::Matrix3d covariance = fit.precision.block<3, 3>(at, at).inverse();
  return covariance.llt().matrixL();
}

double normal_density(double squared, double widening) {
  return std::exp(-0.5 * squared / (widening * widening)) / (widening * widening * widening);
}

}  // namespace

double standard_normal(Dice& dice) {
  const double radius = std::sqrt(-2.0 * std::log(1.0 - dice.unit()));
  return radius * std::cos(2.0 * std::numbers::pi * dice.unit());
}

ContactRidge::ContactRidge(const FitProblem& problem, const Fit& fit, std::size_t contact) {
  const auto at = static_cast<Eigen::Index>(kParametersPerContact * contact);
  const Eigen::Matrix4d covariance = fit.precision.block<4, 4>(at, at).inverse();
  width_ = std::clamp(kWidthShare * std::sqrt(covariance(3, 3)), kMinWidth, kMaxWidth);
  const FitContact& centre = fit.contacts[contact];
  std::vector<Cell> below = follow(problem, fit, contact, -width_);
  std::reverse(below.begin(), below.end());
  cells_ = std::move(below);
  cells_.push_back({centre.log_radius,
                    fit.objective,
                    {centre.position_mm.x(), centre.position_mm.y(), centre.log_force},
                    place_root(fit, at)});
  for (Cell& cell : follow(problem, fit, contact, width_)) cells_.push_back(std::move(cell));
  share_out();
}

std::vector<ContactRidge::Cell> ContactRidge::follow(const FitProblem& problem, Fit fit, std::size_t contact,
                                                     double step) const {
  const auto at = static_cast<Eigen::Index>(kParametersPerContact * contact);
  std::vector<Eigen::Index> frozen;
  for (Eigen::Index k = 0; k < parameters_of(fit.contacts).size(); ++k) {
    if (k < at || k >= at + 3) frozen.push_back(k);
  }
  const double lowest = fit.objective;
  std::vector<Cell> cells;
  for (int k = 0; k < kMaxCells; ++k) {
    fit.contacts[contact].log_radius += step;
    auto next = fit_contacts(problem, fit.contacts, kFollowSteps, frozen);
    if (!next || next->objective > lowest + kMaxRise) break;
    fit = *std::move(next);
    const FitContact& c = fit.contacts[contact];
    cells.push_back(
        {c.log_radius, fit.objective, {c.position_mm.x(), c.position_mm.y(), c.log_force}, place_root(fit, at)});
  }
  return cells;
}

// A cell holds exp(−objective / 2) times the volume of its normal distribution; a smaller factor than a half lets the
// tails be drawn, too.
void ContactRidge::share_out() {
  double lowest = std::numeric_limits<double>::infinity(), sum = 0.0;
  for (const Cell& c : cells_) lowest = std::min(lowest, c.objective);
  for (Cell& c : cells_) {
    c.share = std::exp(-0.35 * (c.objective - lowest) + log_determinant(c.root) - log_determinant(cells_[0].root));
    sum += c.share;
  }
  for (Cell& c : cells_) c.share /= sum;
}

Eigen::Vector3d ContactRidge::place_at(std::size_t cell, double log_radius) const {
  const double offset = (log_radius - cells_[cell].log_radius) / width_;
  const std::size_t other = offset > 0.0 ? cell + 1 : cell - 1;
  if (other >= cells_.size()) return cells_[cell].place;
  return cells_[cell].place + std::abs(offset) * (cells_[other].place - cells_[cell].place);
}

ContactVector ContactRidge::draw(Dice& dice) const {
  double rest = dice.unit();
  std::size_t k = 0;
  while (k + 1 < cells_.size() && rest >= cells_[k].share) rest -= cells_[k++].share;
  const double log_radius = cells_[k].log_radius + width_ * (dice.unit() - 0.5);
  const double widening = dice.unit() < kFarShare ? kFarWidening : kWidening;
  Eigen::Vector3d unit;
  for (double& u : unit) u = standard_normal(dice);
  ContactVector at;
  at << place_at(k, log_radius) + widening * (cells_[k].root * unit), log_radius;
  return at;
}

double ContactRidge::log_density(const ContactVector& at) const {
  const double position = (at[3] - cells_.front().log_radius) / width_ + 0.5;
  if (!(position >= 0.0 && position < static_cast<double>(cells_.size())))
    return -std::numeric_limits<double>::infinity();
  const auto k = static_cast<std::size_t>(position);
  const Cell& cell = cells_[k];
  const Eigen::Vector3d unit =
      cell.root.triangularView<Eigen::Lower>().solve(at.head<3>() - place_at(k, at[3]));
  const double squared = unit.squaredNorm();
  const double mixed =
      (1.0 - kFarShare) * normal_density(squared, kWidening) + kFarShare * normal_density(squared, kFarWidening);
  return std::log(cell.share * mixed) - log_determinant(cell.root);
}

}  // namespace triskin::mechanics
