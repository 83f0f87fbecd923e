// SPDX-License-Identifier: GPL-3.0-or-later
#include "radial_solution.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "triskin/mechanics/layer.hpp"

namespace triskin::mechanics {
namespace {

// The deficit falls as exp(−2k) and the base kernel as exp(−k), so the omitted part is below 1e-9 of the pressure.
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
  const double a = contact_radius_;
  const double bent = (deficit_transform(density) * (spectrum_.nodes * a).cos()).sum();
  density.edge = 2.0 / std::numbers::pi * (indentation - gap.abel(a) + bent);
  return density;
}

RadialDensity RadialSystem::solve_smooth(const RadialGap& gap, double& indentation) const {
  const RadialDensity flat = solve(1.0, flat_gap());
  RadialDensity density = solve(0.0, gap);
  indentation = -density.edge / flat.edge;
  density.values += indentation * flat.values;
  density.edge = 0.0;
  return density;
}

Eigen::ArrayXd RadialSystem::deficit_transform(const RadialDensity& density) const {
  return deficit_ * (cosines_ * (nodes_.weights * density.values).matrix()).array();
}

double RadialSystem::force(const RadialDensity& density) const {
  return 2.0 * std::numbers::pi * (nodes_.weights * density.values).sum();
}

Eigen::ArrayXd RadialSystem::sine_sums() const {
  const Eigen::MatrixXd sines = (spectrum_.nodes.matrix() * nodes_.nodes.matrix().transpose()).array().sin().matrix();
  return (sines * (nodes_.weights / nodes_.nodes).matrix()).array();
}

double RadialSystem::centre_pressure(const RadialDensity& density, const RadialGap& gap,
                                     const Eigen::ArrayXd& sine_sums) const {
  // p(0) = g(a)/a − ∫ g′(t)/t dt, where g′ follows from the integral equation itself.
  const double from_gap = (nodes_.weights * sampled(nodes_, gap.abel_slope_over_t)).sum();
  const double from_layer = (deficit_transform(density) * spectrum_.nodes * sine_sums).sum();
  return density.edge / contact_radius_ + 2.0 / std::numbers::pi * (from_gap + from_layer);
}

FieldSpectrum::FieldSpectrum(const RadialSystem& system, double reach)
    : rule(spectral_rule(kBaseCutoff, system.contact_radius() + reach)),
      cosines(cosine_matrix(rule.nodes, system.nodes().nodes)),
      deficit(kernel_terms(rule, system.poisson(), compliance_deficit)),
      base(kernel_terms(rule, system.poisson(), base_pressure_ratio)) {}

RadialField::RadialField(const RadialSystem& system, RadialDensity density, const FieldSpectrum& spectrum)
    : contact_radius_(system.contact_radius()),
      density_(std::move(density)),
      interpolate_(system.nodes(), contact_radius_),
      wave_numbers_(spectrum.rule.nodes) {
  const Eigen::ArrayXd transform = (spectrum.cosines * (system.nodes().weights * density_.values).matrix()).array();
  deficit_terms_ = spectrum.deficit * transform;
  base_terms_ = spectrum.base * transform * wave_numbers_;
}

double RadialField::displacement_outside(double r) const {
  return half_space_displacement(r) - bessel_sum(deficit_terms_, wave_numbers_, r);
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
  return bessel_sum(base_terms_, wave_numbers_, r);
}

double bessel_sum(const Eigen::ArrayXd& terms, const Eigen::ArrayXd& wave_numbers, double r) {
  double sum = 0.0;
  for (Eigen::Index i = 0; i < terms.size(); ++i) sum += terms[i] * ::j0(wave_numbers[i] * r);
  return sum;
}

}  // namespace triskin::mechanics
