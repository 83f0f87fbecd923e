// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <Eigen/Core>
#include <vector>

#include "contact_fit.hpp"
#include "triskin/base/dice.hpp"

namespace triskin::mechanics {

/// Four parameters of one contact: x, y, ln F, ln R.
using ContactVector = Eigen::Vector4d;

/// The ridge of the posterior of one contact, the others as fitted: for each tip radius the best place and force, and
/// their normal distribution there. A blunt tip far away and a sharp one near by explain few taxels alike, so the ridge
/// is long and bent, and a distribution that follows it proposes samples that are taken.
class ContactRidge {
 public:
  ContactRidge(const FitProblem& problem, const Fit& fit, std::size_t contact);
  [[nodiscard]] ContactVector draw(Dice& dice) const;
  /// Logarithm of the density that draw() has, but for a constant; minus infinity beside the ridge.
  [[nodiscard]] double log_density(const ContactVector& at) const;

 private:
  // Cells of equal width in ln R; each has the optimum at its centre, the root of the covariance and its share of draws.
  struct Cell {
    double log_radius, objective;
    Eigen::Vector3d place;
    Eigen::Matrix3d root;
    double share = 0.0;
  };
  [[nodiscard]] std::vector<Cell> follow(const FitProblem& problem, Fit fit, std::size_t contact, double step) const;
  void share_out();
  [[nodiscard]] Eigen::Vector3d place_at(std::size_t cell, double log_radius) const;

  double width_ = 0.0;
  std::vector<Cell> cells_;
};

/// A standard normal number by Box and Muller's transform: equal on every compiler.
[[nodiscard]] double standard_normal(Dice& dice);

}  // namespace triskin::mechanics
