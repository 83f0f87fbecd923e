// SPDX-License-Identifier: GPL-3.0-or-later
#include "contact_posterior.hpp"

#include <Eigen/Eigenvalues>
#include <cmath>
#include <optional>
#include <utility>

#include "contact_chain.hpp"

namespace triskin::mechanics {
namespace {

// The objective is tested this many deviations from its minimum, and may differ by this fraction of its quadratic
// growth.
constexpr double kLookDeviations = 1.5, kMaxCurvatureError = 0.25;

// A contact is resolved if the Gauss-Newton matrix gives smaller deviations of its place and ln F than these.
constexpr double kResolved_mm = 0.5, kResolvedLogForce = 0.1;

// A fit replaces another one if its evidence objective is lower by this much; the samples are then drawn again, so many
// times at most.
constexpr double kMinEvidenceGain = 0.1;
constexpr int kMaxRounds = 3;

using Vector = Eigen::VectorXd;
using Matrix = Eigen::MatrixXd;

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

// Returns the optimum with the deviations from the Gauss-Newton matrix.
std::vector<ContactMoments> optimum_moments(const Fit& fit) {
  const Vector deviation = covariance_of(fit.precision).diagonal().cwiseSqrt();
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
  const Eigen::Vector4d shift = sampled.mean - optimum.mean;
  return {optimum.mean, (sampled.deviation.cwiseAbs2() + shift.cwiseAbs2()).cwiseSqrt()};
}

// Copies of a tempered chain also find optima that no start of a search led to. Returns the better fit, if there is
// one.
std::optional<Fit> better_fit(const FitProblem& problem, const Fit& fit, const ChainSamples& samples) {
  std::optional<Fit> better = fit_contacts(problem, samples.best);
  return better && evidence_objective(*better) < evidence_objective(fit) - kMinEvidenceGain ? better : std::nullopt;
}

std::vector<ContactMoments> combined(const ChainSamples& samples, std::vector<ContactMoments> optimum) {
  for (std::size_t c = 0; c < optimum.size(); ++c) optimum[c] = about_optimum(samples.moments[c], optimum[c]);
  return optimum;
}

}  // namespace

std::vector<ContactMoments> posterior_moments(const FitProblem& problem, Fit& fit) {
  if (fit.contacts.empty()) return {};
  for (int round = 0;; ++round) {
    if (is_normal(problem, fit)) return optimum_moments(fit);
    const ChainSamples samples = sample_posterior(problem, fit);
    std::optional<Fit> better = round < kMaxRounds ? better_fit(problem, fit, samples) : std::nullopt;
    if (!better) return combined(samples, optimum_moments(fit));
    fit = *std::move(better);
  }
}

}  // namespace triskin::mechanics
