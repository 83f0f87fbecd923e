// SPDX-License-Identifier: GPL-3.0-or-later
#include "contact_prior.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "units.hpp"

namespace triskin::mechanics {
namespace {

// The deviation of an overlap is this share of the thickness.
constexpr double kOverlapShare = 0.2;
// Keeps the matrix regular if a contact moves no taxel; the gradient does not include it.
constexpr double kRidgePerMm2 = 1.0 / (20.0 * 20.0);

Eigen::Vector2d from_nearest_taxel(std::span<const Eigen::Vector2d> taxels, const Eigen::Vector2d& position) {
  Eigen::Vector2d offset = Eigen::Vector2d::Zero();
  double nearest = std::numeric_limits<double>::infinity();
  for (const Eigen::Vector2d& t : taxels) {
    const double distance = (position - t).squaredNorm();
    if (distance >= nearest) continue;
    nearest = distance;
    offset = position - t;
  }
  return offset;
}

double square(double x) {
  return x * x;
}

}  // namespace

FitPriors priors_for(const Layer& layer) {
  FitPriors priors;
  priors.overlap_sd_mm = kOverlapShare * layer.thickness_mm;
  const double depth = layer.thickness_mm / 4.0;
  const double stiffness = confined_modulus_kpa(layer) / layer.thickness_mm / kKpaMm2PerN;
  priors.log_force = std::log(std::numbers::pi * std::exp(priors.log_radius) * depth * depth * stiffness);
  return priors;
}

double prior_objective(const FitPriors& priors, std::span<const Eigen::Vector2d> taxels_mm,
                       std::span<const FitContact> contacts) {
  double sum = 0.0;
  for (const FitContact& c : contacts) {
    const double beyond = from_nearest_taxel(taxels_mm, c.position_mm).norm() - priors.free_distance_mm;
    sum += square(std::max(0.0, beyond) / priors.distance_sd_mm) +
           square((c.log_force - priors.log_force) / priors.log_force_sd) +
           square((c.log_radius - priors.log_radius) / priors.log_radius_sd);
  }
  return sum;
}

void add_prior(const FitPriors& priors, std::span<const Eigen::Vector2d> taxels_mm,
               std::span<const FitContact> contacts, Eigen::MatrixXd& matrix, Eigen::VectorXd& half_gradient) {
  Eigen::Index at = 0;
  for (const FitContact& c : contacts) {
    const Eigen::Vector2d offset = from_nearest_taxel(taxels_mm, c.position_mm);
    const double distance = offset.norm(), beyond = distance - priors.free_distance_mm;
    matrix.diagonal().segment<2>(at).array() += kRidgePerMm2;
    if (beyond > 0.0) {
      const Eigen::Vector2d slope = offset / distance / priors.distance_sd_mm;
      matrix.block<2, 2>(at, at) += slope * slope.transpose();
      half_gradient.segment<2>(at) += slope * beyond / priors.distance_sd_mm;
    }
    const double force_weight = 1.0 / square(priors.log_force_sd), radius_weight = 1.0 / square(priors.log_radius_sd);
    matrix(at + 2, at + 2) += force_weight;
    matrix(at + 3, at + 3) += radius_weight;
    half_gradient[at + 2] += force_weight * (c.log_force - priors.log_force);
    half_gradient[at + 3] += radius_weight * (c.log_radius - priors.log_radius);
    at += kParametersPerContact;
  }
}

}  // namespace triskin::mechanics
