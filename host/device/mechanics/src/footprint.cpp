// SPDX-License-Identifier: GPL-3.0-or-later
#include "triskin/mechanics/footprint.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "quadrature.hpp"
#include "triskin/base/error.hpp"
#include "units.hpp"
#include "value_between.hpp"

namespace triskin::mechanics {
namespace {

constexpr double kProfileStep_mm = 0.2;
constexpr int kRadiusSamples = 80;
// The integrand falls as k⁻⁴, so the neglected rest is less than 10⁻⁴ of the value on the axis.
constexpr double kHighestWaveNumber_per_mm = 12.0;
constexpr double kReachShare = 2e-4;
// Farther than this from its edge, in thicknesses, a contact moves no taxel.
constexpr double kFarThicknesses = 8.0;

double radius_of(int index) {
  constexpr double kSpan = Footprint::kMaxContactRadius_mm / Footprint::kMinContactRadius_mm;
  return Footprint::kMinContactRadius_mm * std::pow(kSpan, static_cast<double>(index) / (kRadiusSamples - 1));
}

// Returns the transform of Hertz' pressure with integral 1: 3 (sin x − x cos x) / x³.
double hertz_transform(double x) {
  if (x < 0.05) return 1.0 - x * x / 10.0;
  return 3.0 * (std::sin(x) - x * std::cos(x)) / (x * x * x);
}

// Returns the transform of a paraboloid of pressure with integral 1: 8 J₂(x) / x².
double paraboloid_transform(double x) {
  if (x < 0.05) return 1.0 - x * x / 12.0;
  return 8.0 * ::jn(2, x) / (x * x);
}

// A contact much smaller than the thickness presses as on a half-space, a wide one as on independent columns.
double pressure_transform(double wave_number, double radius, double thickness) {
  const double wide = radius / (radius + 3.0 * thickness), x = wave_number * radius;
  return (1.0 - wide) * hertz_transform(x) + wide * paraboloid_transform(x);
}

// Returns the transform of the mean over a disc: 2 J₁(x) / x.
double disc_transform(double x) {
  return x < 1e-4 ? 1.0 : 2.0 * ::j1(x) / x;
}

// Returns the transform of the displacement, divided by h / K, the displacement under an even pressure.
double layer_transform(double wave_number, const Layer& layer) {
  const double even = layer.thickness_mm / confined_modulus_kpa(layer);
  return half_space_compliance_per_kpa(layer) * compliance_ratio(wave_number * layer.thickness_mm, layer.poisson) /
         wave_number / even;
}

Layer checked(const Layer& layer, double disc_diameter_mm) {
  check(layer);
  if (!(disc_diameter_mm >= 0.1 && disc_diameter_mm <= 20.0))
    throw InputError(fmt::format("footprint: the discs are {} mm across; give 0.1 … 20", disc_diameter_mm));
  return layer;
}

}  // namespace

Footprint::Footprint(const Layer& layer, double disc_diameter_mm) {
  const Layer soft = checked(layer, disc_diameter_mm);
  const double farthest = kMaxContactRadius_mm + disc_diameter_mm + kFarThicknesses * soft.thickness_mm;
  const Quadrature rule = spectral_rule(kHighestWaveNumber_per_mm, farthest);
  const Eigen::ArrayXd distances =
      Eigen::ArrayXd::LinSpaced(static_cast<Eigen::Index>(farthest / kProfileStep_mm) + 1, 0.0,
                                std::floor(farthest / kProfileStep_mm) * kProfileStep_mm);
  const Eigen::MatrixXd waves =
      (distances.matrix() * rule.nodes.matrix().transpose()).unaryExpr([](double x) { return ::j0(x); });
  const Eigen::ArrayXd common = rule.nodes.unaryExpr([&](double k) {
    return kKpaMm2PerN / (2.0 * std::numbers::pi) * k * disc_transform(k * disc_diameter_mm / 2.0) *
           layer_transform(k, soft);
  });
  for (int index = 0; index < kRadiusSamples; ++index) {
    const double radius = radius_of(index);
    const Eigen::ArrayXd spectrum =
        rule.nodes.unaryExpr([&](double k) { return pressure_transform(k, radius, soft.thickness_mm); });
    const Eigen::VectorXd values = waves * (rule.weights * common * spectrum).matrix();
    Profile& profile = profiles_.emplace_back();
    profile.values.assign(values.begin(), values.end());
    while (profile.values.size() > 1 && std::abs(profile.values.back()) < kReachShare * profile.values.front())
      profile.values.pop_back();
    profile.reach_mm = kProfileStep_mm * static_cast<double>(profile.values.size());
    profile.values.push_back(0.0);
  }
}

double Footprint::Profile::at(double distance_mm) const {
  return value_between(values, distance_mm / kProfileStep_mm);
}

Footprint::Place Footprint::place_of(double contact_radius_mm) {
  static const double step = std::log(radius_of(1) / radius_of(0));
  const double position =
      std::clamp(std::log(contact_radius_mm / kMinContactRadius_mm) / step, 0.0, kRadiusSamples - 1.0);
  const std::size_t index = std::min(static_cast<std::size_t>(position), static_cast<std::size_t>(kRadiusSamples - 2));
  return {index, position - static_cast<double>(index)};
}

double Footprint::kpa_per_newton(double contact_radius_mm, double distance_mm) const {
  const auto [index, share] = place_of(contact_radius_mm);
  const double lower = profiles_[index].at(distance_mm), upper = profiles_[index + 1].at(distance_mm);
  return lower + share * (upper - lower);
}

double Footprint::reach_mm(double contact_radius_mm) const {
  return profiles_[place_of(contact_radius_mm).index + 1].reach_mm;
}

}  // namespace triskin::mechanics
