// SPDX-License-Identifier: GPL-3.0-or-later
#include "winkler.hpp"

#include <cmath>
#include <numbers>

#include "foundation.hpp"
#include "root.hpp"
#include "triskin/base/error.hpp"
#include "units.hpp"

namespace triskin::mechanics {
namespace {

// Returns the displaced volume (mm³, of a line mm²) at which columns of 1 kPa/mm carry the force.
double displaced(const Indenter& indenter, double indentation_mm) {
  const double radius = indenter.radius_mm, d = indentation_mm;
  switch (indenter.shape) {
    case Shape::kSphere:
      return std::numbers::pi * d * d * (3.0 * radius - d) / 3.0;
    case Shape::kParaboloid:
      return std::numbers::pi * radius * d * d;
    case Shape::kFlatPunch:
      return std::numbers::pi * radius * radius * d;
    case Shape::kLine:
      return 4.0 / 3.0 * d * std::sqrt(2.0 * radius * d);
  }
  return 0.0;
}

double indentation_for(const Indenter& indenter, double volume, double limit_mm) {
  if (displaced(indenter, limit_mm) <= volume) return limit_mm;
  return root_between(0.0, limit_mm, [&](double d) { return displaced(indenter, d) - volume; });
}

}  // namespace

Contact press_winkler(const Layer& layer, const Indenter& indenter, double force) {
  check(layer);
  check(indenter);
  check_force(force);
  const double stiffness = confined_modulus_kpa(layer) / layer.thickness_mm;
  const double volume = kKpaMm2PerN * force / stiffness;
  const bool ends_at_equator = indenter.shape == Shape::kSphere && indenter.radius_mm < layer.thickness_mm;
  if (ends_at_equator && displaced(indenter, indenter.radius_mm) <= volume)
    throw InputError("contact: the sphere would sink to its equator; lower the force or take a larger radius");
  const double limit = ends_at_equator ? indenter.radius_mm : layer.thickness_mm;
  const double indentation = indentation_for(indenter, volume, limit);
  check_indentation(layer, indentation);
  return foundation_contact(indenter, force, indentation, [stiffness](double u) { return stiffness * u; });
}

}  // namespace triskin::mechanics
