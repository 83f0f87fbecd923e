// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <Eigen/Core>
#include <array>
#include <vector>

namespace triskin::mechanics {

/// The tables cover these contact radii, and profiles reach this far from the edge, in thicknesses of the layer.
inline constexpr double kMinTableRadius = 0.03;
inline constexpr double kMaxTableRadius = 40.0;
inline constexpr double kProfileReach = 16.0;

/// Stores the effect of one gap at one contact radius. Profiles are sampled at the points of profile_points().
struct TableRow {
  double indentation = 0.0, force = 0.0, peak = 0.0;
  Eigen::ArrayXd displacement;  // The displacement is sampled outside the contact.
  Eigen::ArrayXd base_outside, base_inside;

  TableRow& operator+=(const TableRow& other);
  [[nodiscard]] TableRow scaled(double factor) const;
};

/// Returns distances from the edge, 0 … kProfileReach, which are dense at the edge.
[[nodiscard]] Eigen::ArrayXd outside_points();
/// Returns distances from the axis, from the edge inwards.
[[nodiscard]] Eigen::ArrayXd inside_points(double contact_radius);

/// Interpolates the value at `distance` outside or inside the contact cubically. Zero beyond the reach.
[[nodiscard]] double outside_value(const Eigen::ArrayXd& profile, double distance_from_edge);
[[nodiscard]] double inside_value(const Eigen::ArrayXd& profile, double distance, double contact_radius);

/// The rows follow the logarithm of the contact radius.
class ProfileTable {
 public:
  [[nodiscard]] static std::vector<double> radii();
  explicit ProfileTable(std::vector<TableRow> rows) : rows_(std::move(rows)) {}
  /// Interpolates cubically between rows.
  [[nodiscard]] TableRow at(double contact_radius) const;
  /// Interpolates only indentation, force and peak.
  [[nodiscard]] TableRow numbers_at(double contact_radius) const;

 private:
  std::vector<TableRow> rows_;
};

/// Makes tables of round contacts: a flat punch of unit indentation, then gaps (r/a)², (r/a)⁴, (r/a)⁶.
[[nodiscard]] std::array<ProfileTable, 4> round_tables(double poisson);
/// Makes the table of lines with the gap (x/a)².
[[nodiscard]] ProfileTable line_table(double poisson);

}  // namespace triskin::mechanics
