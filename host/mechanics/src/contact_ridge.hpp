// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <Eigen/Core>
#include <vector>

#include "contact_fit.hpp"
#include "triskin/base/dice.hpp"

namespace triskin::mechanics {

/// Four parameters of one contact: x, y, ln F, ln R.
using ContactVector = Eigen::Vector4d;

/// Means and standard deviations of x, y (mm), force (N) and radius (mm) of one contact.
struct ContactMoments {
  Eigen::Vector4d mean, deviation;
};

/// Proposals for one contact, the others as fitted. A blunt tip far away and a sharp one near by explain few taxels
/// alike, so the posterior is a long, bent ridge: for each tip radius there is a best place and force, with their
/// normal distribution about it. Where a contact presses one taxel only, ridges on several sides of the taxel stand
/// side by side. A distribution that follows them proposes samples that are taken.
class ContactProposal {
 public:
  /// Whether optima on other sides of the nearest taxel are looked for.
  enum class Sides { kOne, kAll };
  ContactProposal(const FitProblem& problem, const Fit& fit, std::size_t contact, Sides sides);
  [[nodiscard]] ContactVector draw(Dice& dice) const;
  /// Logarithm of the density that draw() has, but for a constant; minus infinity beside the ridges.
  [[nodiscard]] double log_density(const ContactVector& at) const;
  /// Moments of the posterior as the cells have it: exp(−objective / 2) times the volume of each normal distribution.
  [[nodiscard]] ContactMoments moments() const;

 private:
  // The optimum at one ln R, the root of the covariance there and the share of draws.
  struct Cell {
    double log_radius, objective;
    Eigen::Vector3d place;
    Eigen::Matrix3d root;
    double share = 0.0;
  };
  // Cells of equal width in ln R.
  struct Ridge {
    double width = 0.0, share = 0.0;
    std::vector<Cell> cells;
    [[nodiscard]] Eigen::Vector3d place_at(std::size_t cell, double log_radius) const;
    [[nodiscard]] double density(const ContactVector& at) const;
  };
  [[nodiscard]] static std::vector<Fit> modes(const FitProblem& problem, const Fit& fit, std::size_t contact);
  [[nodiscard]] static std::vector<Cell> followed(const FitProblem& problem, Fit fit, std::size_t contact, double step);
  [[nodiscard]] static Ridge ridge_from(const FitProblem& problem, const Fit& fit, std::size_t contact);
  void share_out();

  std::vector<Ridge> ridges_;
};

/// A standard normal number by Box and Muller's transform: equal on every compiler.
[[nodiscard]] double standard_normal(Dice& dice);

}  // namespace triskin::mechanics
