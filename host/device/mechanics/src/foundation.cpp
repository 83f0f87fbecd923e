// SPDX-License-Identifier: GPL-3.0-or-later
#include "foundation.hpp"

#include <cmath>
#include <utility>

namespace triskin::mechanics {
namespace {

class FoundationField : public ContactField {
 public:
  FoundationField(const Indenter& indenter, double indentation_mm, std::function<double(double)> law)
      : indenter_(indenter),
        indentation_mm_(indentation_mm),
        contact_radius_mm_(foundation_radius_mm(indenter, indentation_mm)),
        law_(std::move(law)) {}
  [[nodiscard]] double displacement_mm(double distance_mm) const override {
    return distance_mm > contact_radius_mm_ ? 0.0 : indentation_mm_ - gap_mm(indenter_, distance_mm);
  }
  [[nodiscard]] double base_pressure_kpa(double distance_mm) const override {
    return law_(displacement_mm(distance_mm));
  }

 private:
  Indenter indenter_;
  double indentation_mm_, contact_radius_mm_;
  std::function<double(double)> law_;
};

}  // namespace

double gap_mm(const Indenter& indenter, double distance_mm) {
  const double squared = distance_mm * distance_mm;
  const double radius = indenter.radius_mm;
  if (indenter.shape == Shape::kFlatPunch) return 0.0;
  if (indenter.shape == Shape::kSphere) return squared / (radius + std::sqrt(radius * radius - squared));
  return squared / (2.0 * radius);
}

double foundation_radius_mm(const Indenter& indenter, double indentation_mm) {
  const double radius = indenter.radius_mm;
  if (indenter.shape == Shape::kFlatPunch) return radius;
  if (indenter.shape != Shape::kSphere) return std::sqrt(2.0 * radius * indentation_mm);
  return indentation_mm >= radius ? radius : std::sqrt(indentation_mm * (2.0 * radius - indentation_mm));
}

Contact foundation_contact(const Indenter& indenter, double force, double indentation_mm,
                           std::function<double(double)> law) {
  Contact contact;
  contact.is_line = indenter.shape == Shape::kLine;
  contact.force = force;
  contact.indentation_mm = indentation_mm;
  contact.contact_radius_mm = foundation_radius_mm(indenter, indentation_mm);
  contact.peak_pressure_kpa = law(indentation_mm);
  contact.field = std::make_shared<FoundationField>(indenter, indentation_mm, std::move(law));
  return contact;
}

}  // namespace triskin::mechanics
