// SPDX-License-Identifier: GPL-3.0-or-later
#include "profile_table.hpp"

#include <algorithm>
#include <cmath>

#include "line_solution.hpp"
#include "quadrature.hpp"
#include "radial_solution.hpp"

namespace triskin::mechanics {
namespace {

constexpr int kRadii = 44;
constexpr int kOutsideIntervals = 56;
constexpr int kInsideIntervals = 40;

double cubic_value(const Eigen::ArrayXd& values, double position) {
  const Eigen::Index last = values.size() - 4;
  const Eigen::Index first = std::clamp(static_cast<Eigen::Index>(position) - 1, Eigen::Index{0}, last);
  const auto w = cubic_weights(position - static_cast<double>(first));
  return w[0] * values[first] + w[1] * values[first + 1] + w[2] * values[first + 2] + w[3] * values[first + 3];
}

double log_step() {
  return std::log(kMaxTableRadius / kMinTableRadius) / (kRadii - 1);
}

Eigen::MatrixXd bessel_matrix(const Eigen::ArrayXd& distances, const Eigen::ArrayXd& wave_numbers) {
  return (distances.matrix() * wave_numbers.matrix().transpose()).unaryExpr([](double x) { return ::j0(x); });
}

struct RowPoints {
  Eigen::ArrayXd distances, sine_sums;
  FieldSpectrum spectrum;
  Eigen::MatrixXd outside, inside;
};

RowPoints row_points(const RadialSystem& system) {
  const double radius = system.contact_radius();
  FieldSpectrum spectrum(system, radius + kProfileReach);
  const Eigen::ArrayXd distances = radius + outside_points();
  Eigen::MatrixXd outside = bessel_matrix(distances, spectrum.rule.nodes);
  Eigen::MatrixXd inside = bessel_matrix(inside_points(radius), spectrum.rule.nodes);
  return {distances, system.sine_sums(), std::move(spectrum), std::move(outside), std::move(inside)};
}

TableRow round_row(const RadialSystem& system, const RowPoints& points, int basis) {
  const RadialGap gap = basis == 0 ? flat_gap() : monomial_gap(basis, system.contact_radius());
  TableRow row;
  row.indentation = 1.0;
  RadialDensity density = basis == 0 ? system.solve(1.0, gap) : system.solve_smooth(gap, row.indentation);
  row.force = system.force(density);
  row.peak = system.centre_pressure(density, gap, points.sine_sums);
  const RadialField field(system, std::move(density), points.spectrum);
  row.displacement = points.distances.unaryExpr([&](double r) { return field.half_space_displacement(r); });
  row.displacement -= (points.outside * field.deficit_terms().matrix()).array();
  row.base_outside = points.outside * field.base_terms().matrix();
  row.base_inside = points.inside * field.base_terms().matrix();
  return row;
}

std::array<TableRow, 4> round_rows(double poisson, double radius) {
  const RadialSystem system(poisson, radius);
  const RowPoints points = row_points(system);
  return {round_row(system, points, 0), round_row(system, points, 1), round_row(system, points, 2),
          round_row(system, points, 3)};
}

TableRow line_row(double poisson, double half_width) {
  const LineSolution solution(poisson, half_width, 2.0 / (half_width * half_width));
  TableRow row;
  row.indentation = solution.indentation();
  row.force = solution.force();
  row.peak = solution.centre_pressure();
  const auto base = [&](double x) { return solution.base_pressure(x); };
  const Eigen::ArrayXd distances = half_width + outside_points();
  row.displacement = distances.unaryExpr([&](double x) { return solution.displacement_outside(x); });
  row.base_outside = distances.unaryExpr(base);
  row.base_inside = inside_points(half_width).unaryExpr(base);
  return row;
}

}  // namespace

TableRow& TableRow::operator+=(const TableRow& other) {
  indentation += other.indentation;
  force += other.force;
  peak += other.peak;
  displacement += other.displacement;
  base_outside += other.base_outside;
  base_inside += other.base_inside;
  return *this;
}

TableRow TableRow::scaled(double factor) const {
  return {factor * indentation,  factor * force,        factor * peak,
          factor * displacement, factor * base_outside, factor * base_inside};
}

Eigen::ArrayXd outside_points() {
  return kProfileReach * Eigen::ArrayXd::LinSpaced(kOutsideIntervals + 1, 0.0, 1.0).cube();
}

Eigen::ArrayXd inside_points(double contact_radius) {
  return contact_radius * (1.0 - Eigen::ArrayXd::LinSpaced(kInsideIntervals + 1, 0.0, 1.0).square());
}

double outside_value(const Eigen::ArrayXd& profile, double distance_from_edge) {
  if (distance_from_edge >= kProfileReach) return 0.0;
  return cubic_value(profile, kOutsideIntervals * std::cbrt(std::max(0.0, distance_from_edge) / kProfileReach));
}

double inside_value(const Eigen::ArrayXd& profile, double distance, double contact_radius) {
  return cubic_value(profile, kInsideIntervals * std::sqrt(std::max(0.0, 1.0 - distance / contact_radius)));
}

std::vector<double> ProfileTable::radii() {
  std::vector<double> radii;
  for (int k = 0; k < kRadii; ++k) radii.push_back(kMinTableRadius * std::exp(k * log_step()));
  return radii;
}

TableRow ProfileTable::at(double contact_radius) const {
  const double position = std::log(contact_radius / kMinTableRadius) / log_step();
  const auto first = static_cast<std::size_t>(std::clamp(static_cast<int>(position) - 1, 0, kRadii - 4));
  const auto weights = cubic_weights(position - static_cast<double>(first));
  TableRow row = rows_[first].scaled(weights[0]);
  for (std::size_t k = 1; k < 4; ++k) row += rows_[first + k].scaled(weights[k]);
  return row;
}

TableRow ProfileTable::numbers_at(double contact_radius) const {
  const double position = std::log(contact_radius / kMinTableRadius) / log_step();
  const auto first = static_cast<std::size_t>(std::clamp(static_cast<int>(position) - 1, 0, kRadii - 4));
  const auto weights = cubic_weights(position - static_cast<double>(first));
  TableRow row;
  for (std::size_t k = 0; k < 4; ++k) {
    row.indentation += weights[k] * rows_[first + k].indentation;
    row.force += weights[k] * rows_[first + k].force;
    row.peak += weights[k] * rows_[first + k].peak;
  }
  return row;
}

std::array<ProfileTable, 4> round_tables(double poisson) {
  std::array<std::vector<TableRow>, 4> rows;
  for (const double radius : ProfileTable::radii()) {
    auto at_radius = round_rows(poisson, radius);
    for (std::size_t basis = 0; basis < 4; ++basis) rows[basis].push_back(std::move(at_radius[basis]));
  }
  return {ProfileTable(std::move(rows[0])), ProfileTable(std::move(rows[1])), ProfileTable(std::move(rows[2])),
          ProfileTable(std::move(rows[3]))};
}

ProfileTable line_table(double poisson) {
  std::vector<TableRow> rows;
  for (const double radius : ProfileTable::radii()) rows.push_back(line_row(poisson, radius));
  return ProfileTable(std::move(rows));
}

}  // namespace triskin::mechanics
