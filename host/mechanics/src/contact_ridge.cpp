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

// The width of a cell is a fraction of the fit's deviation of ln R, bounded for radii that the fit hardly determines.
constexpr double kWidthShare = 0.6, kMaxWidth = 0.3, kMinWidth = 1e-5;
constexpr int kMaxCells = 20, kFollowSteps = 5;
// A ridge ends where the density has fallen to exp(−8), and one that starts below exp(−5) is left out.
constexpr double kMaxRise = 16.0, kMaxModeRise = 10.0;
// Modes are searched on this many sides of the nearest taxel, each by a fit with this many steps.
constexpr int kSides = 6, kModeSteps = 10;
constexpr double kSideDistance_mm = 3.5, kModeDistance_mm = 1.0;
// Along the circle about a single taxel the Gauss-Newton matrix has no bound, and the circle bends away from it.
constexpr double kMaxDeviation_mm = 2.0;
// Draws are wider than the normal distribution, and some are much wider, so that tails are covered.
constexpr double kWidening = 1.2, kFarWidening = 3.0, kFarShare = 0.2;
// Draws fall off along a ridge more slowly than the density, whose exponent would be 0.5, to reach its tails.
constexpr double kShareExponent = 0.35;

double log_determinant(const Eigen::Matrix3d& root) {
  return root.diagonal().array().log().sum();
}

Eigen::Index first_parameter(std::size_t contact) {
  return static_cast<Eigen::Index>(kParametersPerContact * contact);
}

// Returns the root of the covariance of place and force at a given radius.
Eigen::Matrix3d place_root(const Fit& fit, std::size_t contact) {
  Eigen::Matrix3d precision = fit.precision.block<3, 3>(first_parameter(contact), first_parameter(contact));
  precision.diagonal().head<2>().array() += 1.0 / (kMaxDeviation_mm * kMaxDeviation_mm);
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

double normal_density(double squared, double widening) {
  return std::exp(-0.5 * squared / (widening * widening)) / (widening * widening * widening);
}

Eigen::Vector2d nearest_taxel(const FitProblem& problem, const Eigen::Vector2d& position) {
  const auto& taxels = problem.model.positions_mm();
  return *std::min_element(taxels.begin(), taxels.end(), [&](const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
    return (a - position).squaredNorm() < (b - position).squaredNorm();
  });
}

}  // namespace

double standard_normal(Dice& dice) {
  const double radius = std::sqrt(-2.0 * std::log(1.0 - dice.unit()));
  return radius * std::cos(2.0 * std::numbers::pi * dice.unit());
}

ContactProposal::ContactProposal(const FitProblem& problem, const Fit& fit, std::size_t contact, Sides sides) {
  const std::vector<Fit> starts = sides == Sides::kAll ? modes(problem, fit, contact) : std::vector<Fit>{fit};
  for (const Fit& mode : starts) ridges_.push_back(ridge_from(problem, mode, contact));
  share_out();
}

// Returns the fit, and optima at its tip radius on other sides of the nearest taxel.
std::vector<Fit> ContactProposal::modes(const FitProblem& problem, const Fit& fit, std::size_t contact) {
  std::vector<Fit> found = {fit};
  const auto frozen = all_but_place(fit, contact);
  const Eigen::Vector2d taxel = nearest_taxel(problem, fit.contacts[contact].position_mm);
  for (int side = 0; side < kSides; ++side) {
    const double angle = 2.0 * std::numbers::pi * side / kSides;
    std::vector<FitContact> start = fit.contacts;
    start[contact].position_mm = taxel + kSideDistance_mm * Eigen::Vector2d(std::cos(angle), std::sin(angle));
    auto mode = fit_contacts(problem, start, kModeSteps, frozen);
    if (!mode || mode->objective > fit.objective + kMaxModeRise) continue;
    const Eigen::Vector2d place = mode->contacts[contact].position_mm;
    const bool is_new = std::all_of(found.begin(), found.end(), [&](const Fit& other) {
      return (other.contacts[contact].position_mm - place).norm() > kModeDistance_mm;
    });
    if (is_new) found.push_back(*std::move(mode));
  }
  return found;
}

ContactProposal::Ridge ContactProposal::ridge_from(const FitProblem& problem, const Fit& fit, std::size_t contact) {
  Ridge ridge;
  const Eigen::Index at = first_parameter(contact);
  // At a mode that was found with the radius frozen, its variance is at most that of the prior.
  const double radius_variance = fit.precision.block<4, 4>(at, at).inverse()(3, 3);
  ridge.width = std::clamp(kWidthShare * std::sqrt(radius_variance), kMinWidth, kMaxWidth);
  ridge.cells = followed(problem, fit, contact, -ridge.width);
  std::reverse(ridge.cells.begin(), ridge.cells.end());
  ridge.cells.push_back(
      {fit.contacts[contact].log_radius, fit.objective, place_of(fit.contacts[contact]), place_root(fit, contact)});
  for (Cell& cell : followed(problem, fit, contact, ridge.width)) ridge.cells.push_back(std::move(cell));
  return ridge;
}

std::vector<ContactProposal::Cell> ContactProposal::followed(const FitProblem& problem, Fit fit, std::size_t contact,
                                                             double step) {
  const auto frozen = all_but_place(fit, contact);
  double lowest = fit.objective;
  std::vector<Cell> cells;
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

void ContactProposal::share_out() {
  double lowest = std::numeric_limits<double>::infinity(), sum = 0.0;
  for (const Ridge& r : ridges_) {
    for (const Cell& c : r.cells) lowest = std::min(lowest, c.objective);
  }
  const double unit = log_determinant(ridges_[0].cells[0].root);
  for (Ridge& r : ridges_) {
    for (Cell& c : r.cells) {
      c.share = r.width * std::exp(-kShareExponent * (c.objective - lowest) + log_determinant(c.root) - unit);
      sum += c.share;
    }
  }
  for (Ridge& r : ridges_) {
    for (Cell& c : r.cells) r.share += c.share /= sum;
  }
}

Eigen::Vector3d ContactProposal::Ridge::place_at(std::size_t cell, double log_radius) const {
  const double offset = (log_radius - cells[cell].log_radius) / width;
  const std::size_t other = offset > 0.0 ? cell + 1 : cell - 1;
  if (other >= cells.size()) return cells[cell].place;
  return cells[cell].place + std::abs(offset) * (cells[other].place - cells[cell].place);
}

double ContactProposal::Ridge::density(const ContactVector& at) const {
  const double position = (at[3] - cells.front().log_radius) / width + 0.5;
  if (!(position >= 0.0 && position < static_cast<double>(cells.size()))) return 0.0;
  const auto k = static_cast<std::size_t>(position);
  const Cell& cell = cells[k];
  const Eigen::Vector3d unit = cell.root.triangularView<Eigen::Lower>().solve(at.head<3>() - place_at(k, at[3]));
  const double squared = unit.squaredNorm();
  const double mixed =
      (1.0 - kFarShare) * normal_density(squared, kWidening) + kFarShare * normal_density(squared, kFarWidening);
  return cell.share / width * mixed / cell.root.diagonal().prod();
}

ContactVector ContactProposal::draw(Dice& dice) const {
  double rest = dice.unit();
  std::size_t r = 0, k = 0;
  while (r + 1 < ridges_.size() && rest >= ridges_[r].share) rest -= ridges_[r++].share;
  const Ridge& ridge = ridges_[r];
  while (k + 1 < ridge.cells.size() && rest >= ridge.cells[k].share) rest -= ridge.cells[k++].share;
  const double log_radius = ridge.cells[k].log_radius + ridge.width * (dice.unit() - 0.5);
  const double widening = dice.unit() < kFarShare ? kFarWidening : kWidening;
  Eigen::Vector3d unit;
  for (double& u : unit) u = standard_normal(dice);
  ContactVector at;
  at << ridge.place_at(k, log_radius) + widening * (ridge.cells[k].root * unit), log_radius;
  return at;
}

double ContactProposal::log_density(const ContactVector& at) const {
  double sum = 0.0;
  for (const Ridge& r : ridges_) sum += r.density(at);
  return std::log(sum);
}

ContactMoments ContactProposal::moments() const {
  double lowest = std::numeric_limits<double>::infinity(), sum = 0.0;
  for (const Ridge& r : ridges_) {
    for (const Cell& c : r.cells) lowest = std::min(lowest, c.objective);
  }
  Eigen::Vector4d mean = Eigen::Vector4d::Zero(), square = Eigen::Vector4d::Zero();
  for (const Ridge& r : ridges_) {
    for (const Cell& c : r.cells) {
      const double weight = r.width * std::exp(-0.5 * (c.objective - lowest)) * c.root.diagonal().prod();
      const Eigen::Vector3d variance = c.root.rowwise().squaredNorm();
      // The force is lognormal about its optimum.
      const double force = std::exp(c.place[2] + variance[2] / 2.0), radius = std::exp(c.log_radius);
      const Eigen::Vector4d value(c.place[0], c.place[1], force, radius);
      const double radius_variance = radius * radius * r.width * r.width / 12.0;
      const Eigen::Vector4d spread(variance[0], variance[1], force * force * std::expm1(variance[2]), radius_variance);
      sum += weight;
      mean += weight * value;
      square += weight * (value.cwiseAbs2() + spread);
    }
  }
  mean /= sum;
  return {mean, (square / sum - mean.cwiseAbs2()).cwiseMax(0.0).cwiseSqrt()};
}

}  // namespace triskin::mechanics
