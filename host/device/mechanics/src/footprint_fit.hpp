// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <Eigen/Core>
#include <optional>
#include <span>

#include "triskin/mechanics/footprint.hpp"

namespace triskin::mechanics {

/// The taxels lie in a plane; the deviation tells how far a value may be from the model.
struct PlaneTaxels {
  std::span<const Eigen::Vector2d> places_mm;
  const Eigen::VectorXd& kpa;
  double sd_kpa = 0.0;
};

/// The prior gives the logarithms of radius and force with deviations, independently of the place.
struct FootprintPrior {
  double log_radius = 0.0, log_radius_sd = 0.0;
  double log_force = 0.0, log_force_sd = 0.0;
};

/// The fit gives mean and deviations of the posterior of one contact.
struct FootprintFit {
  Eigen::Vector2d position_mm = Eigen::Vector2d::Zero(), position_sd_mm = Eigen::Vector2d::Zero();
  double force_n = 0.0, force_sd_n = 0.0, radius_mm = 0.0;
};

/// Fits one contact within `half_width_mm` of `about_mm`. Returns nothing if no positive force improves the fit. Cost:
/// about 2,000 sums over the taxels.
[[nodiscard]] std::optional<FootprintFit> fit_footprint(const Footprint& footprint, const PlaneTaxels& taxels,
                                                        const FootprintPrior& prior, const Eigen::Vector2d& about_mm,
                                                        double half_width_mm);

/// Returns the values in kPa that the taxels would read under the fitted contact.
[[nodiscard]] Eigen::VectorXd predicted_kpa(const Footprint& footprint, std::span<const Eigen::Vector2d> places_mm,
                                            const FootprintFit& fit);

}  // namespace triskin::mechanics
