// SPDX-License-Identifier: GPL-3.0-or-later
#include "contact_posterior.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <cmath>

#include "triskin/base/dice.hpp"

namespace triskin::mechanics {
namespace {

constexpr int kWarmUpSteps = 100, kSteps = 800;
// Around a single taxel the matrix does not bound the place.
constexpr double kMaxStep_mm = 2.0;
constexpr std::uint64_t kSeed = 20190814;
// The objective is tested this many deviations from its minimum, and may differ by this fraction of its quadratic
// growth.
constexpr double kLookDeviations = 1.5, kMaxCurvatureError = 0.25;

// A contact is resolved if the Gauss-Newton matrix gives smaller deviations of its place and ln F than these.
constexpr double kResolved_mm = 0.5, kResolvedLogForce = 0.1;

using Vector = Eigen::VectorXd;
using Matrix = Eigen::MatrixXd;

Matrix inverse_of(const Matrix& precision) {
  return precision.ldlt().solve(Matrix::Identity(precision.rows(), precision.cols()));
}

bool is_normal(const FitProblem& problem, const Fit& fit) {
  const Eigen::SelfAdjointEigenSolver<Matrix> axes(fit.precision);
  const Vector centre = parameters_of(fit.contacts);
  const double expected = kLookDeviations * kLookDeviations;
  for (Eigen::Index k = 0; k < centre.size(); ++k) {
    if (!(axes.eigenvalues()[k] > 0.0)) return false;
    const Vector offset = kLookDeviations / std::sqrt(axes.eigenvalues()[k]) * axes.eigenvectors().col(k);
    for (const double side : {1.0, -1.0}) {
      const double growth = posterior_objective(problem, contacts_from(centre + side * offset)) - fit.objective;
      if (!(std::abs(growth - expected) < kMaxCurvatureError * expected)) return false;
    }
  }
  return true;
}

// Samples all contacts. Each sweep proposes for each contact a place on its ridge and a step from its current place,
// and a step of all of them.
class Chain {
 public:
  Chain(const FitProblem& problem, const Fit& fit)
      : problem_(problem), at_(parameters_of(fit.contacts)), objective_(fit.objective), dice_(kSeed) {
    joint_ = root_of(inverse_of(fit.precision));
    for (std::size_t c = 0; c < fit.contacts.size(); ++c) {
      proposals_.emplace_back(problem, fit, c, ContactProposal::Sides::kAll);
      const auto at = static_cast<Eigen::Index>(kParametersPerContact * c);
      Matrix precision = fit.precision.block<4, 4>(at, at);
      precision.diagonal().head<2>().array() += 1.0 / (kMaxStep_mm * kMaxStep_mm);
      steps_.push_back(root_of(inverse_of(precision)));
    }
  }
  [[nodiscard]] std::vector<ContactMoments> sample() {
    for (int step = 0; step < kWarmUpSteps; ++step) sweep();
    const Eigen::Index n = at_.size();
    Vector mean = Vector::Zero(n), square = Vector::Zero(n);
    for (int step = 1; step <= kSteps; ++step) {
      sweep();
      // The moments are updated by Welford's method.
      const Vector values = physical(), difference = values - mean;
      mean += difference / step;
      square += difference.cwiseProduct(values - mean);
    }
    const Vector deviation = (square / (kSteps - 1)).cwiseSqrt();
    std::vector<ContactMoments> moments;
    for (Eigen::Index at = 0; at < n; at += kParametersPerContact)
      moments.push_back({mean.segment<4>(at), deviation.segment<4>(at)});
    return moments;
  }

 private:
  static Matrix root_of(const Matrix& covariance) { return covariance.llt().matrixL(); }
  void sweep() {
    for (std::size_t c = 0; c < proposals_.size(); ++c) {
      jump(c);
      Vector step = Vector::Zero(at_.size());
      step.segment<4>(static_cast<Eigen::Index>(kParametersPerContact * c)) = drawn(steps_[c]);
      move(at_ + step, 0.0);
    }
    if (proposals_.size() > 1) move(at_ + drawn(joint_), 0.0);
  }
  void jump(std::size_t contact) {
    const auto at = static_cast<Eigen::Index>(kParametersPerContact * contact);
    const ContactVector here = at_.segment<4>(at), there = proposals_[contact].draw(dice_);
    Vector place = at_;
    place.segment<4>(at) = there;
    move(place, proposals_[contact].log_density(here) - proposals_[contact].log_density(there));
  }
  // A step has the length that Gelman, Roberts and Gilks advise: 2.4 deviations over the root of the dimension.
  Vector drawn(const Matrix& root) {
    Vector unit(root.rows());
    for (double& u : unit) u = standard_normal(dice_);
    return 2.4 / std::sqrt(static_cast<double>(root.rows())) * (root * unit);
  }
  // Applies Metropolis and Hastings' rule; the correction is the logarithm of the ratio of proposals, backward over
  // forward.
  void move(const Vector& place, double correction) {
    const double chance = 1.0 - dice_.unit();
    const double objective = posterior_objective(problem_, contacts_from(place));
    if (!(0.5 * (objective - objective_) < correction - std::log(chance))) return;
    at_ = place;
    objective_ = objective;
  }
  [[nodiscard]] Vector physical() const {
    Vector values = at_;
    for (Eigen::Index at = 0; at < at_.size(); at += kParametersPerContact)
      values.segment<2>(at + 2) = at_.segment<2>(at + 2).array().exp();
    return values;
  }

  const FitProblem& problem_;
  Vector at_;
  double objective_;
  Dice dice_;
  Matrix joint_;
  std::vector<Matrix> steps_;
  std::vector<ContactProposal> proposals_;
};

}  // namespace

std::vector<ContactMoments> ridge_moments(const FitProblem& problem, const Fit& fit) {
  std::vector<ContactMoments> moments;
  for (std::size_t c = 0; c < fit.contacts.size(); ++c)
    moments.push_back(ContactProposal(problem, fit, c, ContactProposal::Sides::kOne).moments());
  return moments;
}

namespace {

// Returns the optimum with the deviations from the Gauss-Newton matrix.
std::vector<ContactMoments> optimum_moments(const Fit& fit) {
  const Vector deviation = inverse_of(fit.precision).diagonal().cwiseSqrt();
  std::vector<ContactMoments> moments;
  Eigen::Index at = 0;
  for (const FitContact& c : fit.contacts) {
    const double force = std::exp(c.log_force), radius = std::exp(c.log_radius);
    const Eigen::Vector4d scale(1.0, 1.0, force, radius);
    moments.push_back(
        {{c.position_mm.x(), c.position_mm.y(), force, radius}, scale.cwiseProduct(deviation.segment<4>(at))});
    at += kParametersPerContact;
  }
  return moments;
}

bool is_resolved(const ContactMoments& optimum) {
  return optimum.deviation.head<2>().norm() <= kResolved_mm &&
         optimum.deviation[2] <= kResolvedLogForce * optimum.mean[2];
}

// The mean of the samples follows the tails, including those of a neighbour that the taxels hardly see. For a resolved
// contact the optimum is the efficient estimate; the tails then only widen its deviation.
ContactMoments about_optimum(const ContactMoments& sampled, const ContactMoments& optimum) {
  if (!is_resolved(optimum)) return sampled;
  const ContactVector shift = sampled.mean - optimum.mean;
  return {optimum.mean, (sampled.deviation.cwiseAbs2() + shift.cwiseAbs2()).cwiseSqrt()};
}

}  // namespace

std::vector<ContactMoments> posterior_moments(const FitProblem& problem, const Fit& fit) {
  if (fit.contacts.empty()) return {};
  std::vector<ContactMoments> moments = optimum_moments(fit);
  if (is_normal(problem, fit)) return moments;
  const std::vector<ContactMoments> sampled = Chain(problem, fit).sample();
  for (std::size_t c = 0; c < moments.size(); ++c) moments[c] = about_optimum(sampled[c], moments[c]);
  return moments;
}

}  // namespace triskin::mechanics
