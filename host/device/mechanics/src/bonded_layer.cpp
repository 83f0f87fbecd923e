// SPDX-License-Identifier: GPL-3.0-or-later
#include "bonded_layer.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "bonded_line.hpp"
#include "radial_solution.hpp"
#include "root.hpp"
#include "triskin/base/error.hpp"
#include "units.hpp"

namespace triskin::mechanics {
namespace {

constexpr double kMaxContactRadius = 60.0;
constexpr double kEquator = 0.999;

RadialGap gap_of(const Indenter& indenter, double thickness_mm) {
  const double radius = indenter.radius_mm / thickness_mm;
  if (indenter.shape == Shape::kSphere) return sphere_gap(radius);
  return indenter.shape == Shape::kParaboloid ? paraboloid_gap(radius) : flat_gap();
}

// Lengths are in thicknesses of the layer.
struct Solved {
  RadialField field;
  double contact_radius, indentation, centre_pressure;
  RadialGap gap;
};

class BondedField : public ContactField {
 public:
  BondedField(const Layer& layer, Solved solved) : layer_(layer), solved_(std::move(solved)) {}
  [[nodiscard]] double displacement_mm(double distance_mm) const override {
    const double r = distance_mm / layer_.thickness_mm;
    if (r > solved_.contact_radius + kFieldReach) return 0.0;
    const bool is_inside = r <= solved_.contact_radius;
    const double u = is_inside ? solved_.indentation - solved_.gap.gap(r) : solved_.field.displacement_outside(r);
    return u * layer_.thickness_mm;
  }
  [[nodiscard]] double base_pressure_kpa(double distance_mm) const override {
    const double r = distance_mm / layer_.thickness_mm;
    if (r > solved_.contact_radius + kFieldReach) return 0.0;
    return solved_.field.base_pressure(r) / half_space_compliance_per_kpa(layer_);
  }

 private:
  Layer layer_;
  Solved solved_;
};

Contact round_contact(const Layer& layer, double force, Solved solved) {
  Contact contact;
  contact.force = force;
  contact.indentation_mm = solved.indentation * layer.thickness_mm;
  contact.contact_radius_mm = solved.contact_radius * layer.thickness_mm;
  contact.peak_pressure_kpa = solved.centre_pressure / half_space_compliance_per_kpa(layer);
  check_indentation(layer, contact.indentation_mm);
  contact.field = std::make_shared<BondedField>(layer, std::move(solved));
  return contact;
}

Solved solved_contact(const RadialSystem& system, RadialDensity density, double indentation, const RadialGap& gap) {
  const double pressure = system.centre_pressure(density, gap, system.sine_sums());
  const FieldSpectrum spectrum(system, system.contact_radius() + kFieldReach);
  return {RadialField(system, std::move(density), spectrum), system.contact_radius(), indentation, pressure, gap};
}

double smooth_force(const RadialSystem& system, const RadialGap& gap, double& indentation) {
  return system.force(system.solve_smooth(gap, indentation));
}

[[noreturn]] void refuse_wide_contact() {
  throw InputError(
      fmt::format("contact: it is wider than {:.0f} thicknesses of the layer, where a Winkler foundation is "
                  "as good; use that level",
                  kMaxContactRadius));
}

// Finds the contact radius at which a smooth indenter carries `force`.
double radius_for(double force, double poisson, const RadialGap& gap, double max_radius) {
  const auto excess = [&](double log_radius) {
    double indentation = 0.0;
    const RadialSystem system(poisson, std::exp(log_radius));
    return std::log(smooth_force(system, gap, indentation) / force);
  };
  double low = std::log(std::min(1.0, max_radius) / 2.0), high = low;
  while (excess(low) > 0.0) low -= 1.0;
  while (excess(high) < 0.0) {
    low = high;
    if (high >= std::log(max_radius)) {
      if (max_radius >= kMaxContactRadius) refuse_wide_contact();
      throw InputError("contact: the sphere would sink to its equator; lower the force or take a larger radius");
    }
    high = std::min(high + 0.5, std::log(max_radius));
    double indentation = 0.0;
    const RadialSystem system(poisson, std::exp(low));
    (void)smooth_force(system, gap, indentation);
    if (indentation >= 1.0) return std::exp(low);
  }
  return std::exp(root_between(low, high, excess, 1e-11));
}

Contact press_smooth(const Layer& layer, const Indenter& indenter, double force, double scaled_force) {
  const double radius = indenter.radius_mm / layer.thickness_mm;
  const double limit =
      indenter.shape == Shape::kSphere ? std::min(kEquator * radius, kMaxContactRadius) : kMaxContactRadius;
  const RadialGap gap = gap_of(indenter, layer.thickness_mm);
  const double contact_radius = radius_for(scaled_force, layer.poisson, gap, limit);
  const RadialSystem system(layer.poisson, contact_radius);
  double indentation = 0.0;
  RadialDensity density = system.solve_smooth(gap, indentation);
  return round_contact(layer, force, solved_contact(system, std::move(density), indentation, gap));
}

Contact press_punch(const Layer& layer, double radius_mm, double force, double scaled_force) {
  const double radius = radius_mm / layer.thickness_mm;
  if (radius > kMaxContactRadius) refuse_wide_contact();
  const RadialSystem system(layer.poisson, radius);
  RadialDensity density = system.solve(1.0, flat_gap());
  const double indentation = scaled_force / system.force(density);
  density.values *= indentation;
  density.edge *= indentation;
  return round_contact(layer, force, solved_contact(system, std::move(density), indentation, flat_gap()));
}

}  // namespace

Contact press_bonded(const Layer& layer, const Indenter& indenter, double force) {
  check(layer);
  check(indenter);
  check_force(force);
  if (indenter.shape == Shape::kLine) return press_bonded_line(layer, indenter.radius_mm, force);
  const double h = layer.thickness_mm;
  const double scaled = force * kKpaMm2PerN * half_space_compliance_per_kpa(layer) / (h * h);
  if (indenter.shape == Shape::kFlatPunch) return press_punch(layer, indenter.radius_mm, force, scaled);
  return press_smooth(layer, indenter, force, scaled);
}

}  // namespace triskin::mechanics
