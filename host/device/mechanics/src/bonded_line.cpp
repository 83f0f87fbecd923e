// SPDX-License-Identifier: GPL-3.0-or-later
#include "bonded_line.hpp"

#include <cmath>
#include <utility>

#include "line_solution.hpp"
#include "root.hpp"
#include "triskin/base/error.hpp"
#include "units.hpp"

namespace triskin::mechanics {
namespace {

constexpr double kMaxHalfWidth = 60.0;

class LineField : public ContactField {
 public:
  LineField(const Layer& layer, double radius_mm, double half_width, LineSolution solution)
      : layer_(layer), radius_mm_(radius_mm), half_width_(half_width), solution_(std::move(solution)) {}
  [[nodiscard]] double displacement_mm(double distance_mm) const override {
    const double h = layer_.thickness_mm;
    const double x = distance_mm / h;
    if (x > half_width_ + kFieldReach) return 0.0;
    if (x <= half_width_) return solution_.indentation() * h - distance_mm * distance_mm / (2.0 * radius_mm_);
    return solution_.displacement_outside(x) * h;
  }
  [[nodiscard]] double base_pressure_kpa(double distance_mm) const override {
    const double x = distance_mm / layer_.thickness_mm;
    if (x > half_width_ + kFieldReach) return 0.0;
    return solution_.base_pressure(x) / half_space_compliance_per_kpa(layer_);
  }

 private:
  Layer layer_;
  double radius_mm_, half_width_;
  LineSolution solution_;
};

double half_width_for(double force, double poisson, double curvature) {
  const auto excess = [&](double log_width) {
    return std::log(LineSolution(poisson, std::exp(log_width), curvature).force() / force);
  };
  double low = 0.0, high = 0.0;
  while (excess(low) > 0.0) low -= 1.0;
  while (excess(high) < 0.0) {
    if (LineSolution(poisson, std::exp(high), curvature).indentation() >= 1.0) return std::exp(high);
    if (high >= std::log(kMaxHalfWidth))
      throw InputError("contact: it is wider than 120 thicknesses of the layer; use the level winkler");
    low = high;
    high += 0.5;
  }
  return std::exp(root_between(low, high, excess, 1e-11));
}

}  // namespace

Contact press_bonded_line(const Layer& layer, double radius_mm, double force) {
  const double h = layer.thickness_mm;
  const double scaled = force * kKpaMm2PerN * half_space_compliance_per_kpa(layer) / h;
  const double curvature = h / radius_mm;
  const double half_width = half_width_for(scaled, layer.poisson, curvature);
  LineSolution solution(layer.poisson, half_width, curvature);
  Contact contact;
  contact.is_line = true;
  contact.force = force;
  contact.indentation_mm = solution.indentation() * h;
  contact.contact_radius_mm = half_width * h;
  contact.peak_pressure_kpa = solution.centre_pressure() / half_space_compliance_per_kpa(layer);
  check_indentation(layer, contact.indentation_mm);
  contact.field = std::make_shared<LineField>(layer, radius_mm, half_width, std::move(solution));
  return contact;
}

}  // namespace triskin::mechanics
