// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <Eigen/Core>
#include <vector>

#include "contact_fit.hpp"
#include "triskin/base/dice.hpp"

namespace triskin::mechanics {

/// A contact has four parameters: x, y, ln F, ln R.
using ContactVector = Eigen::Vector4d;

/// Gives means and standard deviations of x, y (mm), force (N) and radius (mm) of one contact.
struct ContactMoments {
  Eigen::Vector4d mean, deviation;
};

/// Proposes samples for one contact, with the others as fitted. A blunt tip far away and a sharp one near by explain
/// few taxels alike, so the posterior is a long, bent ridge: for each tip radius there is a best place and force, with
/// their normal distribution about it. If a contact presses one taxel only, there are parallel ridges on several sides
/// of the taxel. A distribution that follows the ridges proposes samples that are likely to be accepted.
class ContactProposal {
 public:
  /// kAll also searches optima on other sides of the nearest taxel.
  enum class Sides { kOne, kAll };
  ContactProposal(const FitProblem& problem, const Fit& fit, std::size_t contact, Sides sides);
  [[nodiscard]] ContactVector draw(Dice& dice) const;
  /// Returns the logarithm of the density of draw(), up to a constant; minus infinity beside the ridges.
  [[nodiscard]] double log_density(const ContactVector& at) const;
  /// Returns the moments of the posterior according to the cells: exp(−objective / 2) times the volume of each normal
  /// distribution.
  [[nodiscard]] ContactMoments moments() const;

 private:
  // Holds the optimum at one ln R, the root of the covariance there and the fraction of draws.
  struct Cell {
    double log_radius, objective;
    Eigen::Vector3d place;
    Eigen::Matrix3d root;
    double share = 0.0;
  };
  // All cells have equal width in ln R.
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

/// Draws a standard normal number by Box and Muller's transform, which is equal on every compiler.
[[nodiscard]] double standard_normal(Dice& dice);

}  // namespace triskin::mechanics
