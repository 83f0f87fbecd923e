// SPDX-License-Identifier: GPL-3.0-or-later
#include "contact_posterior.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include "triskin/base/dice.hpp"

namespace triskin::mechanics {
namespace {

constexpr int kSamples = 500;
constexpr double kMinEffectiveSamples = 15.0;
// The narrow part of the proposal is wider than the fit says, so that its tails are covered.
constexpr double kWidening = 1.5;
constexpr double kBroadShare = 0.35;
constexpr std::uint64_t kSeed = 20190814;

// A normal distribution of the four parameters.
class Normal {
 public:
  Normal(const Eigen::Vector4d& mean, const Eigen::Matrix4d& covariance)
      : mean_(mean), root_(covariance.llt().matrixL()), log_determinant_(root_.diagonal().array().log().sum()) {}
  [[nodiscard]] Eigen::Vector4d draw(Dice& dice) const {
    Eigen::Vector4d unit;
    for (int k = 0; k < 4; ++k) {
      // Box and Muller's transform: equal on every compiler.
      const double radius = std::sqrt(-2.0 * std::log(1.0 - dice.unit()));
      unit[k] = radius * std::cos(2.0 * std::numbers::pi * dice.unit());
    }
    return mean_ + root_ * unit;
  }
  [[nodiscard]] double log_density(const Eigen::Vector4d& at) const {
    const Eigen::Vector4d unit = root_.triangularView<Eigen::Lower>().solve(at - mean_);
    return -0.5 * unit.squaredNorm() - log_determinant_;
  }

 private:
  Eigen::Vector4d mean_;
  Eigen::Matrix4d root_;
  double log_determinant_;
};

// Standard deviations of the broad part: half the pitch of taxels and what a force and a radius may be wrong by.
Eigen::Matrix4d broad_covariance(const FitPriors& priors) {
  const double radius = std::min(0.7, priors.log_radius_sd);
  return Eigen::Vector4d(2.5 * 2.5, 2.5 * 2.5, 0.5 * 0.5, radius * radius).asDiagonal();
}

struct Sample {
  Eigen::Vector4d values;  // x, y, force, radius
  double log_weight;
};

std::optional<ContactMoments> moments_of(const std::vector<Sample>& samples) {
  double best = -std::numeric_limits<double>::infinity();
  for (const Sample& s : samples) best = std::max(best, s.log_weight);
  double sum = 0.0, squares = 0.0;
  Eigen::Vector4d first = Eigen::Vector4d::Zero(), second = Eigen::Vector4d::Zero();
  for (const Sample& s : samples) {
    const double weight = std::exp(s.log_weight - best);
    sum += weight;
    squares += weight * weight;
    first += weight * s.values;
  }
  if (!(sum * sum / squares > kMinEffectiveSamples)) return std::nullopt;
  first /= sum;
  for (const Sample& s : samples) second += std::exp(s.log_weight - best) / sum * (s.values - first).cwiseAbs2();
  return ContactMoments{first, second.cwiseSqrt()};
}

}  // namespace

std::optional<ContactMoments> sample_posterior(const TaxelModel& model, const Eigen::VectorXd& observed, const Fit& fit,
                                               std::size_t contact, const FitPriors& priors) {
  const auto block = static_cast<Eigen::Index>(kParametersPerContact * contact);
  const FitContact& best = fit.contacts[contact];
  const Eigen::Vector4d centre(best.position_mm.x(), best.position_mm.y(), best.log_force, best.log_radius);
  const Normal narrow(centre, kWidening * kWidening * fit.covariance.block<4, 4>(block, block));
  const Normal broad(centre, broad_covariance(priors));
  Dice dice(kSeed);
  std::vector<FitContact> contacts = fit.contacts;
  std::vector<Sample> samples;
  for (int k = 0; k < kSamples; ++k) {
    const Eigen::Vector4d at = dice.unit() < kBroadShare ? broad.draw(dice) : narrow.draw(dice);
    contacts[contact] = {at.head<2>(), at[2], at[3]};
    const double objective = posterior_objective(model, observed, contacts, fit.prior_centres, fit.noise, priors);
    if (!std::isfinite(objective)) continue;
    const double proposal = std::log(kBroadShare * std::exp(broad.log_density(at)) +
                                     (1.0 - kBroadShare) * std::exp(narrow.log_density(at)));
    samples.push_back({{at[0], at[1], std::exp(at[2]), std::exp(at[3])}, -0.5 * objective - proposal});
  }
  return moments_of(samples);
}

}  // namespace triskin::mechanics
