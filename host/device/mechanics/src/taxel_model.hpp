// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <Eigen/Core>
#include <deque>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "triskin/mechanics/contact_table.hpp"

namespace triskin::mechanics {

/// A contact in the form that the fit varies.
struct FitContact {
  Eigen::Vector2d position_mm;
  double log_force = 0.0, log_radius = 0.0;
};

inline constexpr int kParametersPerContact = 4;

/// Gives the values of the taxels and their derivatives: four columns per contact, by x, y, ln F and ln R. The contact
/// radii have derivatives by ln F and ln R, which are zero if none were wanted.
struct TaxelResponse {
  Eigen::VectorXd values;
  Eigen::MatrixXd derivatives;
  Eigen::VectorXd contact_radii_mm;
  Eigen::MatrixX2d radius_slopes_mm;
};

/// Samples the profile of a displacement evenly over the distance from the axis, for quick look-up.
class SampledProfile {
 public:
  SampledProfile() = default;
  SampledProfile(const ContactField& field, double reach_mm);
  [[nodiscard]] double at(double r) const;
  /// Returns where the profile ends; it is zero beyond.
  [[nodiscard]] double reach_mm() const { return step_ * static_cast<double>(values_.size()); }

 private:
  double step_ = 1.0;
  std::vector<double> values_;
};

/// Evaluates the forward model: discs at given places under contacts of spheres whose displacements add up. It caches
/// the last profiles, so each thread needs its own object.
class TaxelModel {
 public:
  TaxelModel(const ContactTable& table, std::vector<Eigen::Vector2d> positions_mm, double disc_radius_mm);
  /// Returns nothing if a contact is outside of the table or reaches the base of the layer.
  [[nodiscard]] std::optional<TaxelResponse> respond(std::span<const FitContact> contacts, bool with_derivatives) const;
  [[nodiscard]] const ContactTable& table() const { return table_; }
  [[nodiscard]] const std::vector<Eigen::Vector2d>& positions_mm() const { return positions_mm_; }
  [[nodiscard]] double disc_radius_mm() const { return disc_radius_mm_; }

 private:
  struct Profiles;
  class DiscSum;
  using SharedProfiles = std::shared_ptr<const Profiles>;
  [[nodiscard]] SharedProfiles profiles_of(const FitContact& contact, bool with_derivatives) const;

  const ContactTable& table_;
  std::vector<Eigen::Vector2d> positions_mm_;
  double disc_radius_mm_;
  mutable std::deque<SharedProfiles> recent_;
};

}  // namespace triskin::mechanics
