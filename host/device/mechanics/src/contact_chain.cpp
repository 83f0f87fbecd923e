// SPDX-License-Identifier: GPL-3.0-or-later
#include "contact_chain.hpp"

#include <Eigen/Cholesky>
#include <cmath>
#include <numbers>
#include <utility>

namespace triskin::mechanics {
namespace {

constexpr int kWarmUpSweeps = 100, kSweeps = 800;
// The misfit counts fully in the first copy, and in each further one this much less than in the one before.
constexpr int kCopies = 3;
constexpr double kWeightRatio = 0.25;
constexpr std::uint64_t kSeed = 20190814;
// A place is kept for later differences after this many sweeps; the first ones are too alike.
constexpr int kKeepSweeps = 4;
constexpr std::size_t kMinKept = 10;
// A whole difference leads from one optimum to another; most steps are as long as they are best for one optimum.
constexpr double kWholeShare = 0.3, kBlurring = 0.01;

using Vector = Eigen::VectorXd;
using Matrix = Eigen::MatrixXd;

struct ChainState {
  Vector at;
  Objective objective;
};

Matrix root_of(const Matrix& precision) {
  return covariance_of(precision).llt().matrixL();
}

// Samples the prior times the likelihood to the power of `weight`.
class ChainCopy {
 public:
  ChainCopy(const FitProblem& problem, const Fit& fit, double weight)
      : problem_(problem), weight_(weight), state_(evaluated(parameters_of(fit.contacts))), best_(state_) {
    const Matrix precision = with_bounded_places(fit.precision * weight);
    for (Eigen::Index k = 0; k < precision.rows(); k += kParametersPerContact)
      roots_.push_back(root_of(precision.block<kParametersPerContact, kParametersPerContact>(k, k)));
    joint_root_ = root_of(precision);
  }
  // Moves each contact by itself and then all of them.
  void sweep(Dice& dice) {
    Eigen::Index first = 0;
    for (const Matrix& root : roots_) {
      step(dice, root, first);
      jump(dice, first, kParametersPerContact);
      first += kParametersPerContact;
    }
    if (roots_.size() > 1) {
      step(dice, joint_root_, 0);
      jump(dice, 0, first);
    }
    if (++sweeps_ % kKeepSweeps == 0) kept_.push_back(state_.at);
  }
  // Exchanges the places of two copies by Metropolis' rule, which leaves the distribution of both as it is.
  void exchange(ChainCopy& other, Dice& dice) {
    const double gain = (weight_ - other.weight_) * (state_.objective.misfit - other.state_.objective.misfit) / 2.0;
    if (std::log(1.0 - dice.unit()) < gain) std::swap(state_, other.state_);
  }
  [[nodiscard]] const Vector& at() const { return state_.at; }
  [[nodiscard]] const ChainState& best() const { return best_; }

 private:
  [[nodiscard]] ChainState evaluated(Vector at) const {
    const Objective objective = objective_of(problem_, contacts_from(at));
    return {std::move(at), objective};
  }
  // A step has the length that Gelman, Roberts and Gilks advise: 2.4 deviations over the root of the dimension.
  static double step_share(Eigen::Index parameters) { return 2.4 / std::sqrt(static_cast<double>(parameters)); }
  void step(Dice& dice, const Matrix& root, Eigen::Index first) {
    Vector unit(root.rows());
    for (double& u : unit) u = standard_normal(dice);
    Vector place = state_.at;
    place.segment(first, root.rows()) += step_share(root.rows()) * (root * unit);
    move(dice, std::move(place));
  }
  void jump(Dice& dice, Eigen::Index first, Eigen::Index count) {
    if (kept_.size() < kMinKept) return;
    const auto drawn = [&] { return kept_[static_cast<std::size_t>(dice.below(static_cast<int>(kept_.size())))]; };
    const Vector difference = drawn() - drawn();
    const double share = dice.unit() < kWholeShare ? 1.0 : step_share(count) / std::numbers::sqrt2;
    Vector place = state_.at;
    for (Eigen::Index k = first; k < first + count; ++k)
      place[k] += share * difference[k] + kBlurring * standard_normal(dice);
    move(dice, std::move(place));
  }
  void move(Dice& dice, Vector place) {
    const double chance = 1.0 - dice.unit();
    ChainState next = evaluated(std::move(place));
    const double rise =
        weight_ * (next.objective.misfit - state_.objective.misfit) + next.objective.prior - state_.objective.prior;
    if (!(0.5 * rise < -std::log(chance))) return;
    state_ = std::move(next);
    if (state_.objective.total() < best_.objective.total()) best_ = state_;
  }

  const FitProblem& problem_;
  double weight_;
  ChainState state_, best_;
  std::vector<Matrix> roots_;
  Matrix joint_root_;
  std::vector<Vector> kept_;
  int sweeps_ = 0;
};

// Contacts have no names, so two of them may change places; this puts them where they are nearest to the reference.
Vector in_order(Vector at, const Vector& reference) {
  const auto squared = [&](Eigen::Index i, Eigen::Index j) {
    return (at.segment<2>(i) - reference.segment<2>(j)).squaredNorm();
  };
  for (Eigen::Index i = 0; i < at.size(); i += kParametersPerContact) {
    for (Eigen::Index j = 0; j < i; j += kParametersPerContact) {
      if (squared(i, j) + squared(j, i) < squared(i, i) + squared(j, j))
        at.segment<kParametersPerContact>(i).swap(at.segment<kParametersPerContact>(j));
    }
  }
  return at;
}

// Adds up samples by Welford's method, with force and radius instead of their logarithms.
class SampleMoments {
 public:
  void add(Vector values) {
    for (Eigen::Index at = 0; at < values.size(); at += kParametersPerContact)
      values.segment<2>(at + 2) = values.segment<2>(at + 2).array().exp();
    if (count_++ == 0) mean_ = square_ = Vector::Zero(values.size());
    const Vector difference = values - mean_;
    mean_ += difference / count_;
    square_ += difference.cwiseProduct(values - mean_);
  }
  [[nodiscard]] std::vector<ContactMoments> of_contacts() const {
    const Vector deviation = (square_ / (count_ - 1)).cwiseSqrt();
    std::vector<ContactMoments> moments;
    for (Eigen::Index at = 0; at < mean_.size(); at += kParametersPerContact)
      moments.push_back({mean_.segment<4>(at), deviation.segment<4>(at)});
    return moments;
  }

 private:
  int count_ = 0;
  Vector mean_, square_;
};

}  // namespace

double standard_normal(Dice& dice) {
  const double radius = std::sqrt(-2.0 * std::log(1.0 - dice.unit()));
  return radius * std::cos(2.0 * std::numbers::pi * dice.unit());
}

ChainSamples sample_posterior(const FitProblem& problem, const Fit& fit) {
  Dice dice(kSeed);
  std::vector<ChainCopy> copies;
  for (int k = 0; k < kCopies; ++k) copies.emplace_back(problem, fit, std::pow(kWeightRatio, k));
  const Vector reference = copies[0].at();
  SampleMoments moments;
  for (int sweep = -kWarmUpSweeps; sweep < kSweeps; ++sweep) {
    for (ChainCopy& copy : copies) copy.sweep(dice);
    for (std::size_t k = copies.size() - 1; k > 0; --k) copies[k - 1].exchange(copies[k], dice);
    if (sweep >= 0) moments.add(in_order(copies[0].at(), reference));
  }
  const ChainState* best = &copies[0].best();
  for (const ChainCopy& copy : copies) {
    if (copy.best().objective.total() < best->objective.total()) best = &copy.best();
  }
  return {moments.of_contacts(), contacts_from(best->at)};
}

}  // namespace triskin::mechanics
