// SPDX-License-Identifier: GPL-3.0-or-later
#include "triskin/mechanics/layer.hpp"

#include <fmt/format.h>

#include <cmath>

#include "triskin/base/error.hpp"

namespace triskin::mechanics {
namespace {

void check_positive(double value, const char* name, const char* unit) {
  if (!std::isfinite(value) || value <= 0.0)
    throw InputError(fmt::format("layer: {} is {} {}; give a positive number", name, value, unit));
}

// Numerator and denominator of the kernels are multiplied by exp(−2kh), so that nothing overflows.
double scaled_denominator(double wave_number, double kappa) {
  const double decay = std::exp(-2.0 * wave_number);
  return kappa * (1.0 + decay * decay) + (1.0 + kappa * kappa + 4.0 * wave_number * wave_number) * decay;
}

double kappa_of(double poisson) {
  return 3.0 - 4.0 * poisson;
}

}  // namespace

void check(const Layer& layer) {
  check_positive(layer.thickness_mm, "the thickness", "mm");
  check_positive(layer.modulus_kpa, "Young's modulus", "kPa");
  if (!(layer.poisson >= 0.0 && layer.poisson < 0.5)) {
    throw InputError(fmt::format(
        "layer: Poisson's ratio is {}; give at least 0 and less than 0.5 (fabric 0.1 … 0.3, silicone 0.45 … 0.49)",
        layer.poisson));
  }
}

double confined_modulus_kpa(const Layer& layer) {
  const double nu = layer.poisson;
  return layer.modulus_kpa * (1.0 - nu) / ((1.0 + nu) * (1.0 - 2.0 * nu));
}

double half_space_compliance_per_kpa(const Layer& layer) {
  return 2.0 * (1.0 - layer.poisson * layer.poisson) / layer.modulus_kpa;
}

double compliance_ratio(double wave_number, double poisson) {
  const double kappa = kappa_of(poisson);
  const double decay = std::exp(-2.0 * wave_number);
  return (kappa * (1.0 - decay * decay) - 4.0 * wave_number * decay) / scaled_denominator(wave_number, kappa);
}

double compliance_deficit(double wave_number, double poisson) {
  const double kappa = kappa_of(poisson);
  const double decay = std::exp(-2.0 * wave_number);
  const double a = wave_number;
  return decay * (2.0 * kappa * decay + 1.0 + kappa * kappa + 4.0 * a * a + 4.0 * a) / scaled_denominator(a, kappa);
}

double base_pressure_ratio(double wave_number, double poisson) {
  const double n = 2.0 * (1.0 - poisson);
  const double decay = std::exp(-2.0 * wave_number);
  const double top = n * (n * (1.0 + decay) + wave_number * (1.0 - decay)) / 2.0 * std::exp(-wave_number);
  const double rise = (1.0 - decay) / 2.0;
  return top / ((wave_number * wave_number + n * n) * decay + kappa_of(poisson) * rise * rise);
}

}  // namespace triskin::mechanics
