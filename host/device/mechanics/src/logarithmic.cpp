// SPDX-License-Identifier: GPL-3.0-or-later
#include "logarithmic.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "foundation.hpp"
#include "root.hpp"
#include "triskin/base/error.hpp"
#include "units.hpp"

namespace triskin::mechanics {
namespace {

// Returns ∫ −ln(w) · (b − w) dw from 1 − d to 1, in thicknesses of the layer: the sphere's columns, w = 1 −
// u, r dr = (b − w) dw.
double sphere_integral(double radius, double d) {
  const double b = 1.0 + radius - d;
  const auto primitive = [b](double w) {
    return w <= 0.0 ? 0.0 : -b * (w * std::log(w) - w) + w * w * (std::log(w) / 2.0 - 0.25);
  };
  return primitive(1.0) - primitive(1.0 - d);
}

// Does the same with r dr = radius dw.
double paraboloid_integral(double radius, double d) {
  const double w = 1.0 - d;
  return radius * (1.0 - w + (w <= 0.0 ? 0.0 : w * std::log(w)));
}

// Returns ∫ −ln(w + x² / 2R) dx over the half width, where the argument reaches 1.
double line_integral(double radius, double d) {
  const double half_width = std::sqrt(2.0 * radius * d);
  const double w = std::max(0.0, 1.0 - d);
  const double root = std::sqrt(2.0 * radius * w);
  return 2.0 * half_width - 2.0 * root * std::atan2(half_width, root);
}

// Returns the force over the confined modulus, in thicknesses of the layer.
double scaled_force(Shape shape, double radius, double d) {
  switch (shape) {
    case Shape::kSphere:
      return 2.0 * std::numbers::pi * sphere_integral(radius, d);
    case Shape::kParaboloid:
      return 2.0 * std::numbers::pi * paraboloid_integral(radius, d);
    case Shape::kFlatPunch:
      return -std::numbers::pi * radius * radius * std::log1p(-d);
    case Shape::kLine:
      return 2.0 * line_integral(radius, d);
  }
  return 0.0;
}

double indentation_for(Shape shape, double radius, double force) {
  if (shape == Shape::kFlatPunch) return -std::expm1(-force / (std::numbers::pi * radius * radius));
  const double limit = shape == Shape::kSphere ? std::min(1.0, radius) : 1.0;
  if (scaled_force(shape, radius, limit) <= force) return limit;
  return root_between(0.0, limit, [&](double d) { return scaled_force(shape, radius, d) - force; });
}

}  // namespace

Contact press_logarithmic(const Layer& layer, const Indenter& indenter, double force) {
  check(layer);
  check(indenter);
  check_force(force);
  const double h = layer.thickness_mm, modulus = confined_modulus_kpa(layer);
  const double radius = indenter.radius_mm / h;
  const double scale = indenter.shape == Shape::kLine ? h : h * h;
  const double indentation = h * indentation_for(indenter.shape, radius, kKpaMm2PerN * force / (modulus * scale));
  if (indenter.shape == Shape::kSphere && indentation >= indenter.radius_mm)
    throw InputError("contact: the sphere would sink to its equator; lower the force or take a larger radius");
  check_indentation(layer, indentation);
  return foundation_contact(indenter, force, indentation,
                            [modulus, h](double u) { return -modulus * std::log1p(-u / h); });
}

}  // namespace triskin::mechanics
