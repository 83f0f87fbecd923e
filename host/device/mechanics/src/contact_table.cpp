// SPDX-License-Identifier: GPL-3.0-or-later
#include "triskin/mechanics/contact_table.hpp"

#include <fmt/format.h>

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <mutex>
#include <optional>

#include "foundation.hpp"
#include "profile_table.hpp"
#include "root.hpp"
#include "triskin/base/error.hpp"
#include "units.hpp"

namespace triskin::mechanics {
namespace {

constexpr double kMaxSphereRatio = 0.95;

class TableField : public ContactField {
 public:
  TableField(const Layer& layer, const Indenter& indenter, double contact_radius, TableRow row)
      : layer_(layer), indenter_(indenter), contact_radius_(contact_radius), row_(std::move(row)) {}
  [[nodiscard]] double displacement_mm(double distance_mm) const override {
    const double h = layer_.thickness_mm, r = distance_mm / h;
    if (r <= contact_radius_) return row_.indentation * h - gap_mm(indenter_, distance_mm);
    return outside_value(row_.displacement, r - contact_radius_) * h;
  }
  [[nodiscard]] double base_pressure_kpa(double distance_mm) const override {
    const double r = distance_mm / layer_.thickness_mm;
    const double value = r <= contact_radius_ ? inside_value(row_.base_inside, r, contact_radius_)
                                              : outside_value(row_.base_outside, r - contact_radius_);
    return value / half_space_compliance_per_kpa(layer_);
  }

 private:
  Layer layer_;
  Indenter indenter_;
  double contact_radius_;
  TableRow row_;
};

// Returns coefficients of r², r⁴, r⁶, each over the contact radius to its power, that meet the gap at three radii.
Eigen::Vector3d gap_coefficients(const Indenter& indenter, double contact_radius_mm) {
  Eigen::Matrix3d powers;
  Eigen::Vector3d gaps;
  const std::array<double, 3> ratios = {0.5, 0.82, 1.0};
  for (int i = 0; i < 3; ++i) {
    const double ratio = ratios[static_cast<std::size_t>(i)], squared = ratio * ratio;
    powers.row(i) << squared, squared * squared, squared * squared * squared;
    gaps[i] = gap_mm(indenter, ratio * contact_radius_mm);
  }
  return powers.partialPivLu().solve(gaps);
}

}  // namespace

// Holds tables of one Poisson's ratio; each is made when it is first used. ContactTable::Impl holds them, so the class
// cannot be local to this file.
class SharedTables {
 public:
  const std::array<ProfileTable, 4>& round(double poisson) {
    std::call_once(round_once_, [&] { round_.emplace(round_tables(poisson)); });
    return *round_;
  }
  const ProfileTable& line(double poisson) {
    std::call_once(line_once_, [&] { line_.emplace(line_table(poisson)); });
    return *line_;
  }

 private:
  std::once_flag round_once_, line_once_;
  std::optional<std::array<ProfileTable, 4>> round_;
  std::optional<ProfileTable> line_;
};

struct ContactTable::Impl {
  const std::array<ProfileTable, 4>& round() { return tables->round(layer.poisson); }
  const ProfileTable& line() { return tables->line(layer.poisson); }
  // Returns the row of an indenter at a contact radius; `look_up` is ProfileTable::at or ProfileTable::numbers_at. Its
  // lengths are in thicknesses.
  TableRow row(const Indenter& indenter, double radius, bool with_profiles) {
    const double h = layer.thickness_mm;
    const auto look_up = [&](const ProfileTable& table) {
      return with_profiles ? table.at(radius) : table.numbers_at(radius);
    };
    if (indenter.shape == Shape::kFlatPunch) return look_up(round()[0]);
    if (indenter.shape == Shape::kLine) return look_up(line()).scaled(radius * radius * h / (2.0 * indenter.radius_mm));
    const Eigen::Vector3d c = gap_coefficients(indenter, radius * h) / h;
    TableRow sum = look_up(round()[1]).scaled(c[0]);
    if (indenter.shape == Shape::kParaboloid) return sum;
    sum += look_up(round()[2]).scaled(c[1]);
    sum += look_up(round()[3]).scaled(c[2]);
    return sum;
  }
  // Converts the force of a row to N, or N/mm for a line.
  double force_unit(const Indenter& indenter) const {
    const double h = layer.thickness_mm;
    const double area = indenter.shape == Shape::kLine ? h : h * h;
    return area / (half_space_compliance_per_kpa(layer) * kKpaMm2PerN);
  }
  double max_radius(const Indenter& indenter) const {
    if (indenter.shape != Shape::kSphere) return kMaxTableRadius;
    return std::min(kMaxTableRadius, kMaxSphereRatio * indenter.radius_mm / layer.thickness_mm);
  }
  Contact contact(const Indenter& indenter, double radius, TableRow found, double force) {
    Contact contact;
    contact.is_line = indenter.shape == Shape::kLine;
    contact.force = force;
    contact.indentation_mm = found.indentation * layer.thickness_mm;
    contact.contact_radius_mm = radius * layer.thickness_mm;
    contact.peak_pressure_kpa = found.peak / half_space_compliance_per_kpa(layer);
    check_indentation(layer, contact.indentation_mm);
    contact.field = std::make_shared<TableField>(layer, indenter, radius, std::move(found));
    return contact;
  }

  Layer layer;
  std::shared_ptr<SharedTables> tables;
};

ContactTable::ContactTable(const Layer& layer)
    : impl_(std::make_unique<Impl>(Impl{layer, std::make_shared<SharedTables>()})) {
  check(layer);
}

ContactTable::ContactTable(const Layer& layer, const ContactTable& other)
    : impl_(std::make_unique<Impl>(Impl{layer, other.impl_->tables})) {
  check(layer);
  if (layer.poisson != other.layer().poisson)
    throw InputError("contact: a table can be shared only by layers with the same Poisson's ratio");
}

ContactTable::~ContactTable() = default;

const Layer& ContactTable::layer() const {
  return impl_->layer;
}

Contact ContactTable::press_to_radius(const Indenter& indenter, double contact_radius_mm) const {
  check(indenter);
  const double radius = contact_radius_mm / impl_->layer.thickness_mm;
  if (!(radius >= kMinTableRadius && radius <= impl_->max_radius(indenter)))
    throw InputError(fmt::format("contact: a contact radius of {} mm is outside of the table", contact_radius_mm));
  TableRow row = impl_->row(indenter, radius, true);
  const double force = row.force * impl_->force_unit(indenter);
  return impl_->contact(indenter, radius, std::move(row), force);
}

Contact ContactTable::press(const Indenter& indenter, double force) const {
  check(indenter);
  check_force(force);
  const double scaled = force / impl_->force_unit(indenter);
  if (indenter.shape == Shape::kFlatPunch) {
    const double radius = indenter.radius_mm / impl_->layer.thickness_mm;
    if (radius < kMinTableRadius || radius > kMaxTableRadius)
      throw InputError("contact: the punch is outside of the table (0.03 … 40 thicknesses); use the level fft");
    const TableRow row = impl_->row(indenter, radius, true);
    return impl_->contact(indenter, radius, row.scaled(scaled / row.force), force);
  }
  const auto excess = [&](double log_radius) {
    return std::log(impl_->row(indenter, std::exp(log_radius), false).force / scaled);
  };
  const double low = std::log(kMinTableRadius), high = std::log(impl_->max_radius(indenter));
  // A sphere can be smaller than the smallest contact of the table; its gap has no value there.
  if (!(low < high && excess(low) <= 0.0 && excess(high) >= 0.0))
    throw InputError(
        "contact: its radius is outside of the table (0.03 … 40 thicknesses, 0.95 of a sphere); "
        "use the level fft");
  const double radius = std::exp(root_between(low, high, excess, 1e-9));
  return impl_->contact(indenter, radius, impl_->row(indenter, radius, true), force);
}

}  // namespace triskin::mechanics
