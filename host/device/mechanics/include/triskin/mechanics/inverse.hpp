// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <Eigen/Core>
#include <optional>
#include <span>
#include <vector>

#include "triskin/mechanics/contact_table.hpp"

namespace triskin::mechanics {

/// One taxel's observation: where its electrode lies on the plane layer and the relative change of its capacitance.
struct TaxelObservation {
  Eigen::Vector2d position_mm;
  double dc_over_c = 0.0;
};

struct InverseOptions {
  double disc_diameter_mm = 4.0;
  /// Standard deviation of dc_over_c. If it is missing, it is estimated from the scatter about the fit.
  std::optional<double> noise_dc_over_c = std::nullopt;
  /// Number of contacts. If it is missing, a likelihood-ratio test chooses from 0 to max_contacts.
  std::optional<int> contacts = std::nullopt;
  int max_contacts = 6;
  /// Radius of the round tips that press. If it is missing, each contact has its own, with the prior below.
  std::optional<double> tip_radius_mm = std::nullopt;
};

/// One contact with the standard deviations of its values.
struct ContactEstimate {
  Eigen::Vector2d position_mm = Eigen::Vector2d::Zero(), position_sd_mm = Eigen::Vector2d::Zero();
  double force_n = 0.0, force_sd_n = 0.0;
  double tip_radius_mm = 0.0, tip_radius_sd_mm = 0.0;
  double contact_radius_mm = 0.0, indentation_mm = 0.0;
};

struct InverseResult {
  std::vector<ContactEstimate> contacts;  ///< The strongest comes first.
  double noise_dc_over_c = 0.0;           ///< The noise is the given value, or the one that was estimated.
  double residual_dc_over_c = 0.0;        ///< The root mean square of the values that the contacts do not explain.
};

/// Finds the contacts of round tips that explain the values of the taxels.
///
/// 1. Starts: the strongest taxel, and forces on a grid about the pressed taxels, none negative, that explain the
///    displacements (non-negative least squares on the influence of a small punch), joined if they are neighbours.
/// 2. Gauss-Newton with damping on position, force and tip radius of all contacts, with the forward model of the table:
///    displacements of the contacts add up, and a taxel is the mean of h / (h − u) over its disc. Of the minima that
///    the starts lead to, the one that holds most probability wins; without a stated noise, the lowest.
/// 3. A likelihood-ratio test adds contacts one by one; noise passes for one more with a probability of 0.001 at most.
///
/// Estimates and deviations are those of the posterior: of the Gauss-Newton matrix where the objective is a parabola,
/// elsewhere (few pressed taxels) of samples of it, about the optimum where that is known to 0.5 mm and 10 %. If the
/// samples lead to a lower minimum, that one counts.
/// Weak priors keep it regular: a factor of e² about the force that presses a tip of 12 mm by a quarter of the
/// thickness, of e about that radius, and some 6 mm about the taxels; contacts do not overlap. A single pressed taxel
/// cannot tell place, force and radius apart; then the deviations are as wide as the priors.
///
/// `observations` are taxels that feel pressure, any number; those that are not finite are left out. Throws InputError
/// when an option is out of range. Cost: 0.1 … 3 s for 120 taxels beside the table, which is made once; for a stream
/// see surface_contacts.hpp. Thread-safe. Source: Lawson and Hanson, Solving Least Squares Problems (1974), chapter 23;
/// Geyer, Computing Science and Statistics 23 (1991) 156.
[[nodiscard]] InverseResult find_contacts(const ContactTable& table, std::span<const TaxelObservation> observations,
                                          const InverseOptions& options);

/// Returns the relative changes of capacitance that contacts of round tips cause at the positions of `taxels`; this is
/// the forward model of find_contacts(). Only position, force and tip radius of the contacts are read. Throws
/// InputError as ContactTable::press(), and when the displacements add up to the thickness of the layer.
[[nodiscard]] std::vector<double> predict_taxels(const ContactTable& table,
                                                 std::span<const Eigen::Vector2d> taxel_positions_mm,
                                                 std::span<const ContactEstimate> contacts,
                                                 double disc_diameter_mm = 4.0);

}  // namespace triskin::mechanics
