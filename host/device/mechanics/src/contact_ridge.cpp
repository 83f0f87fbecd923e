// SPDX-License-Identifier: GPL-3.0-or-later
#include "contact_ridge.hpp"

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

namespace triskin::mechanics {
namespace {

// The width of a cell is a fraction of the fit's deviation of ln R, bounded for radii that the fit hardly determines.
constexpr double kWidthShare = 0.6, kMaxWidth = 0.3, kMinWidth = 1e-5;
constexpr int kMaxCells = 20, kFollowSteps = 5;
// A ridge ends where the density has fallen to exp(−8).
constexpr double kMaxRise = 16.0;

Eigen::Index first_parameter(std::size_t contact) {
  return static_cast<Eigen::Index>(kParametersPerContact * contact);
}

// Returns the root of the covariance of place and force at a given radius.
Eigen::Matrix3d place_root(const Fit& fit, std::size_t contact) {
  const Eigen::Matrix3d precision =
      with_bounded_places(fit.precision).block<3, 3>(first_parameter(contact), first_parameter(contact));
  return precision.inverse().llt().matrixL();
}

Eigen::Vector3d place_of(const FitContact& c) {
  return {c.position_mm.x(), c.position_mm.y(), c.log_force};
}

// Returns the indices of all parameters except place and force of the contact.
std::vector<Eigen::Index> all_but_place(const Fit& fit, std::size_t contact) {
  const Eigen::Index at = first_parameter(contact);
  std::vector<Eigen::Index> frozen;
  for (Eigen::Index k = 0; k < first_parameter(fit.contacts.size()); ++k) {
    if (k < at || k >= at + 3) frozen.push_back(k);
  }
  return frozen;
}

// Holds the optimum at one ln R and the root of the covariance there.
struct RidgeCell {
  double log_radius, objective;
  Eigen::Vector3d place;
  Eigen::Matrix3d root;
};

// Follows the ridge in steps of ln R from the fit, which is not among the cells.
std::vector<RidgeCell> followed(const FitProblem& problem, Fit fit, std::size_t contact, double step) {
  const auto frozen = all_but_place(fit, contact);
  double lowest = fit.objective;
  std::vector<RidgeCell> cells;
  for (int k = 0; k < kMaxCells; ++k) {
    fit.contacts[contact].log_radius += step;
    auto next = fit_contacts(problem, fit.contacts, kFollowSteps, frozen);
    if (!next || next->objective > lowest + kMaxRise) break;
    fit = *std::move(next);
    lowest = std::min(lowest, fit.objective);
    const FitContact& c = fit.contacts[contact];
    cells.push_back({c.log_radius, fit.objective, place_of(c), place_root(fit, contact)});
  }
  return cells;
}

ContactMoments moments_of(const std::vector<RidgeCell>& cells, double width) {
  double lowest = std::numeric_limits<double>::infinity(), sum = 0.0;
  for (const RidgeCell& c : cells) lowest = std::min(lowest, c.objective);
  Eigen::Vector4d mean = Eigen::Vector4d::Zero(), square = Eigen::Vector4d::Zero();
  for (const RidgeCell& c : cells) {
    const double weight = std::exp(-0.5 * (c.objective - lowest)) * c.root.diagonal().prod();
    const Eigen::Vector3d variance = c.root.rowwise().squaredNorm();
    // The force is lognormal about its optimum.
    const double force = std::exp(c.place[2] + variance[2] / 2.0), radius = std::exp(c.log_radius);
    const Eigen::Vector4d value(c.place[0], c.place[1], force, radius);
    const double radius_variance = radius * radius * width * width / 12.0;
    const Eigen::Vector4d spread(variance[0], variance[1], force * force * std::expm1(variance[2]), radius_variance);
    sum += weight;
    mean += weight * value;
    square += weight * (value.cwiseAbs2() + spread);
  }
  mean /= sum;
  return {mean, (square / sum - mean.cwiseAbs2()).cwiseMax(0.0).cwiseSqrt()};
}

ContactMoments moments_along_ridge(const FitProblem& problem, const Fit& fit, std::size_t contact) {
  const Eigen::Index at = first_parameter(contact);
  const double radius_variance = fit.precision.block<4, 4>(at, at).inverse()(3, 3);
  const double width = std::clamp(kWidthShare * std::sqrt(radius_variance), kMinWidth, kMaxWidth);
  std::vector<RidgeCell> cells = followed(problem, fit, contact, -width);
  const FitContact& c = fit.contacts[contact];
  cells.push_back({c.log_radius, fit.objective, place_of(c), place_root(fit, contact)});
  for (RidgeCell& cell : followed(problem, fit, contact, width)) cells.push_back(std::move(cell));
  return moments_of(cells, width);
}

}  // namespace

std::vector<ContactMoments> ridge_moments(const FitProblem& problem, const Fit& fit) {
  std::vector<ContactMoments> moments;
  for (std::size_t c = 0; c < fit.contacts.size(); ++c) moments.push_back(moments_along_ridge(problem, fit, c));
  return moments;
}

}  // namespace triskin::mechanics
