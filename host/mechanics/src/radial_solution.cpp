// SPDX-License-Identifier: GPL-3.0-or-later
#include "radial_solution.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "triskin/mechanics/layer.hpp"

namespace triskin::mechanics {
namespace {

// The deficit falls as exp(−2k) and the base kernel as exp(−k): what is left out is below 1e-9 of the pressure.
constexpr double kDeficitCutoff = 16.0;
constexpr double kBaseCutoff = 26.0;

// A density changes near the edge over one thickness of the layer, so the count grows with the radius.
int node_count(double contact_radius) {
  return 28 + static_cast<int>(4.0 * contact_radius);
}

Eigen::ArrayXd sampled(const Quadrature& rule, const std::function<double(double)>& f) {
  return rule.nodes.unaryExpr([&](double t) { return f(t); });
}

Eigen::MatrixXd cosine_matrix(const Eigen::ArrayXd& wave_numbers, const Eigen::ArrayXd& nodes) {
  return (wave_numbers.matrix() * nodes.matrix().transpose()).array().cos().matrix();
}

Eigen::ArrayXd kernel_terms(const Quadrature& spectrum, double poisson, double (*kernel)(double, double)) {
  return spectrum.weights * sampled(spectrum, [&](double k) { return kernel(k, poisson); });
}

}  // namespace

RadialGap sphere_gap(double radius) {
  return {[radius](double r) { return r * r / (radius + std::sqrt(radius * radius - r * r)); },
          [radius](double t) { return t * std::atanh(t / radius); },
          [radius](double t) { return std::atanh(t / radius) / t + radius / (radius * radius - t * t); }};
}

RadialGap paraboloid_gap(double radius) {
  return {[radius](double r) { return r * r / (2.0 * radius); }, [radius](double t) { return t * t / radius; },
          [radius](double) { return 2.0 / radius; }};
}

RadialGap flat_gap() {
  const auto zero = [](double) { return 0.0; };
  return {zero, zero, zero};
}

RadialGap monomial_gap(int power, double contact_radius) {
  // ∫₀¹ x^(2m − 1) / √(1 − x²) dx is 1, 2/3, 8/15 for m = 1, 2, 3.
  const double beta = power == 1 ? 1.0 : power == 2 ? 2.0 / 3.0 : 8.0 / 15.0;
  const double scale = std::pow(contact_radius, -2 * power);
  const double two_m = 2.0 * power;
  return {[=](double r) { return scale * std::pow(r, two_m); },
          [=](double t) { return scale * two_m * beta * std::pow(t, two_m); },
          [=](double t) { return scale * two_m * beta * two_m * std::pow(t, two_m - 2.0); }};
}

RadialSystem::RadialSystem(double poisson, double contact_radius)
    : poisson_(poisson),
      contact_radius_(contact_radius),
      nodes_(gauss_legendre(node_count(contact_radius), 0.0, contact_radius)),
      spectrum_(spectral_rule(kDeficitCutoff, 2.0 * contact_radius)),
      cosines_(cosine_matrix(spectrum_.nodes, nodes_.nodes)),
      deficit_(kernel_terms(spectrum_, poisson, compliance_deficit)) {
  Eigen::MatrixXd system = -2.0 / std::numbers::pi *
                           (cosines_.transpose() * deficit_.matrix().asDiagonal() * cosines_) *
                           nodes_.weights.matrix().asDiagonal();
  system.diagonal().array() += 1.0;
  factors_.compute(system);
}

RadialDensity RadialSystem::solve(double indentation, const RadialGap& gap) const {
  const Eigen::VectorXd right = 2.0 / std::numbers::pi * (indentation - sampled(nodes_, gap.abel)).matrix();
  RadialDensity density;
  density.values = factors_.solve(right).array();
  const Eigen::ArrayXd transform = deficit_ * (cosines_ * (nodes_.weights * density.values).matrix()).array();
  const double a = contact_radius_;
  density.edge = 2.0 / std::numbers::pi * (indentation - gap.abel(a) + (transform * (spectrum_.nodes * a).cos()).sum());
  const Eigen::MatrixXd sines = (spectrum_.nodes.matrix() * nodes_.nodes.matrix().transpose()).array().sin().matrix();
  const Eigen::ArrayXd bent = (sines.transpose() * (transform * spectrum_.nodes).matrix()).array() / nodes_.nodes;
  density.slope_over_t = -2.0 / std::numbers::pi * (sampled(nodes_, gap.abel_slope_over_t) + bent);
  return density;
}

RadialDensity RadialSystem::solve_smooth(const RadialGap& gap, double& indentation) const {
  const RadialDensity flat = solve(1.0, flat_gap());
  RadialDensity density = solve(0.0, gap);
  indentation = -density.edge / flat.edge;
  density.values += indentation * flat.values;
  density.slope_over_t += indentation * flat.slope_over_t;
  density.edge = 0.0;
  return density;
}

RadialField::RadialField(const RadialSystem& system, RadialDensity density, double reach)
    : contact_radius_(system.contact_radius()),
      nodes_(system.nodes()),
      spectrum_(spectral_rule(kBaseCutoff, contact_radius_ + reach)),
      density_(std::move(density)),
      interpolate_(nodes_, contact_radius_) {
  const Eigen::ArrayXd transform =
      (cosine_matrix(spectrum_.nodes, nodes_.nodes) * (nodes_.weights * density_.values).matrix()).array();
  deficit_terms_ = kernel_terms(spectrum_, system.poisson(), compliance_deficit) * transform;
  base_terms_ = kernel_terms(spectrum_, system.poisson(), base_pressure_ratio) * transform * spectrum_.nodes;
}

double RadialField::force() const {
  return 2.0 * std::numbers::pi * (nodes_.weights * density_.values).sum();
}

double RadialField::centre_pressure() const {
  return density_.edge / contact_radius_ - (nodes_.weights * density_.slope_over_t).sum();
}

double RadialField::displacement_outside(double r) const {
  return half_space_displacement(r) - bessel_sum(deficit_terms_, spectrum_.nodes, r);
}

double RadialField::half_space_displacement(double r) const {
  // With t = r sin θ the half-space part ∫ g / √(r² − t²) dt has no singularity left.
  const Quadrature angles = gauss_legendre(32, 0.0, std::asin(std::min(1.0, contact_radius_ / r)));
  double half_space = 0.0;
  for (Eigen::Index i = 0; i < angles.nodes.size(); ++i)
    half_space += angles.weights[i] * interpolate_(density_.values, r * std::sin(angles.nodes[i]));
  return half_space;
}

double RadialField::base_pressure(double r) const {
  return bessel_sum(base_terms_, spectrum_.nodes, r);
}

double bessel_sum(const Eigen::ArrayXd& terms, const Eigen::ArrayXd& wave_numbers, double r) {
  double sum = 0.0;
  for (Eigen::Index i = 0; i < terms.size(); ++i) sum += terms[i] * ::j0(wave_numbers[i] * r);
  return sum;
}

}  // namespace triskin::mechanics
