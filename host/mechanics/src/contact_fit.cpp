// SPDX-License-Identifier: GPL-3.0-or-later
#include "contact_fit.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace triskin::mechanics {
namespace {

constexpr int kMaxSteps = 60;
constexpr double kMaxDamping = 1e8;
constexpr double kMaxMove_mm = 3.0, kMaxLogMove = 0.7;

using Contacts = std::vector<FitContact>;

Eigen::VectorXd parameters(const Contacts& contacts) {
  Eigen::VectorXd all(static_cast<Eigen::Index>(kParametersPerContact * contacts.size()));
  for (std::size_t c = 0; c < contacts.size(); ++c) {
    const FitContact& k = contacts[c];
    all.segment<4>(static_cast<Eigen::Index>(4 * c)) << k.position_mm, k.log_force, k.log_radius;
  }
  return all;
}

Contacts contacts_from(const Eigen::VectorXd& all) {
  Contacts contacts;
  for (Eigen::Index i = 0; i < all.size(); i += kParametersPerContact)
    contacts.push_back({all.segment<2>(i), all[i + 2], all[i + 3]});
  return contacts;
}

// The centre and the inverse variance of each parameter's prior.
struct Prior {
  Eigen::VectorXd centre, weight;
};

Prior prior_of(const Contacts& start, const FitPriors& priors) {
  Prior prior{parameters(start), {}};
  prior.weight.resize(prior.centre.size());
  for (Eigen::Index i = 0; i < prior.centre.size(); i += kParametersPerContact) {
    prior.centre[i + 3] = priors.log_radius;
    prior.weight.segment<4>(i) << 1.0 / (priors.position_sd_mm * priors.position_sd_mm),
        1.0 / (priors.position_sd_mm * priors.position_sd_mm), 1.0 / (priors.log_force_sd * priors.log_force_sd),
        1.0 / (priors.log_radius_sd * priors.log_radius_sd);
  }
  return prior;
}

Eigen::VectorXd limited(Eigen::VectorXd step) {
  double longest = 0.0;
  for (Eigen::Index i = 0; i < step.size(); ++i)
    longest = std::max(longest, std::abs(step[i]) / (i % kParametersPerContact < 2 ? kMaxMove_mm : kMaxLogMove));
  return longest > 1.0 ? Eigen::VectorXd(step / longest) : step;
}

class Search {
 public:
  Search(const TaxelModel& model, const Eigen::VectorXd& observed, Prior prior, double noise)
      : model_(model), observed_(observed), prior_(std::move(prior)), noise_(noise) {}

  bool start(const Eigen::VectorXd& at) { return look_at(at); }
  // One accepted step; false when there is no better place.
  bool improve() {
    const Eigen::MatrixXd matrix = normal_matrix();
    const Eigen::VectorXd gradient =
        derivatives_.transpose() * residual_ / (noise_ * noise_) + prior_.weight.cwiseProduct(at_ - prior_.centre);
    while (damping_ < kMaxDamping) {
      Eigen::MatrixXd damped = matrix;
      damped.diagonal() *= 1.0 + damping_;
      const Eigen::VectorXd step = limited(-damped.ldlt().solve(gradient));
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
    const Eigen::Index n = at_.size();
    Fit fit;
    fit.contacts = contacts_from(at_);
    fit.covariance = normal_matrix().ldlt().solve(Eigen::MatrixXd::Identity(n, n));
    fit.residual_sum = residual_.squaredNorm();
    fit.objective = objective_;
    fit.noise = noise_;
    return fit;
  }

 private:
  [[nodiscard]] Eigen::MatrixXd normal_matrix() const {
    Eigen::MatrixXd matrix = derivatives_.transpose() * derivatives_ / (noise_ * noise_);
    matrix.diagonal() += prior_.weight;
    return matrix;
  }
  // Moves there if it is possible and better than here.
  bool look_at(const Eigen::VectorXd& place) {
    auto response = model_.respond(contacts_from(place), true);
    if (!response) return false;
    const Eigen::VectorXd residual = response->values - observed_;
    const double objective =
        residual.squaredNorm() / (noise_ * noise_) + prior_.weight.dot((place - prior_.centre).cwiseAbs2());
    if (!(objective < objective_)) return false;
    at_ = place;
    objective_ = objective;
    residual_ = residual;
    derivatives_ = std::move(response->derivatives);
    return true;
  }

  const TaxelModel& model_;
  const Eigen::VectorXd& observed_;
  Prior prior_;
  double noise_;
  double damping_ = 1e-3;
  double objective_ = std::numeric_limits<double>::infinity();
  Eigen::VectorXd at_, residual_;
  Eigen::MatrixXd derivatives_;
};

}  // namespace

std::optional<Fit> fit_contacts(const TaxelModel& model, const Eigen::VectorXd& observed,
                                const std::vector<FitContact>& start, const std::vector<FitContact>& prior_centres,
                                double noise, const FitPriors& priors) {
  Search search(model, observed, prior_of(prior_centres, priors), noise);
  if (!search.start(parameters(start))) return std::nullopt;
  for (int step = 0; step < kMaxSteps && search.improve(); ++step) {
  }
  Fit fit = search.result();
  fit.prior_centres = prior_centres;
  return fit;
}

double posterior_objective(const TaxelModel& model, const Eigen::VectorXd& observed,
                           const std::vector<FitContact>& contacts, const std::vector<FitContact>& prior_centres,
                           double noise, const FitPriors& priors) {
  const auto response = model.respond(contacts, false);
  if (!response) return std::numeric_limits<double>::infinity();
  const Prior prior = prior_of(prior_centres, priors);
  return (response->values - observed).squaredNorm() / (noise * noise) +
         prior.weight.dot((parameters(contacts) - prior.centre).cwiseAbs2());
}

}  // namespace triskin::mechanics
