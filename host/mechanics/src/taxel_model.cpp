// SPDX-License-Identifier: GPL-3.0-or-later
#include "taxel_model.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "disc_points.hpp"
#include "triskin/host/error.hpp"

namespace triskin::mechanics {
namespace {

constexpr double kSampleStep_mm = 0.05;
// What a contact does farther away from its edge than this many thicknesses is below 0.1 % of its peak.
constexpr double kReachThicknesses = 8.0;
constexpr double kLogStep = 1e-3;

Contact press_tip(const ContactTable& table, double log_force, double log_radius) {
  return table.press({Shape::kSphere, std::exp(log_radius)}, std::exp(log_force));
}

}  // namespace

SampledProfile::SampledProfile(const ContactField& field, double reach_mm) : step_(kSampleStep_mm) {
  const int count = static_cast<int>(std::ceil(reach_mm / step_)) + 1;
  values_.reserve(static_cast<std::size_t>(count));
  for (int k = 0; k < count; ++k) values_.push_back(field.displacement_mm(k * step_));
}

double SampledProfile::at(double r) const {
  const double position = r / step_;
  const auto k = static_cast<std::size_t>(position);
  if (k + 1 >= values_.size()) return 0.0;
  return values_[k] + (position - static_cast<double>(k)) * (values_[k + 1] - values_[k]);
}

// Displacement of one contact and its central differences by ln F and ln R.
struct TaxelModel::Profiles {
  SampledProfile displacement, more_force, less_force, more_radius, less_radius;
  double reach_mm = 0.0;
};

TaxelModel::TaxelModel(const ContactTable& table, std::vector<Eigen::Vector2d> positions_mm, double disc_radius_mm)
    : table_(table), positions_mm_(std::move(positions_mm)), disc_radius_mm_(disc_radius_mm) {}

TaxelModel::Profiles TaxelModel::profiles_of(const FitContact& contact, bool with_derivatives) const {
  const double f = contact.log_force, r = contact.log_radius;
  const Contact pressed = press_tip(table_, f, r);
  Profiles profiles;
  profiles.reach_mm = pressed.contact_radius_mm + kReachThicknesses * table_.layer().thickness_mm;
  const auto sample = [&](const Contact& c) { return SampledProfile(*c.field, profiles.reach_mm); };
  profiles.displacement = sample(pressed);
  if (!with_derivatives) return profiles;
  profiles.more_force = sample(press_tip(table_, f + kLogStep, r));
  profiles.less_force = sample(press_tip(table_, f - kLogStep, r));
  profiles.more_radius = sample(press_tip(table_, f, r + kLogStep));
  profiles.less_radius = sample(press_tip(table_, f, r - kLogStep));
  return profiles;
}

std::optional<TaxelResponse> TaxelModel::respond(std::span<const FitContact> contacts, bool with_derivatives) const {
  std::vector<Profiles> profiles;
  try {
    for (const FitContact& c : contacts) profiles.push_back(profiles_of(c, with_derivatives));
  } catch (const InputError&) {
    return std::nullopt;
  }
  const double h = table_.layer().thickness_mm;
  const auto taxels = static_cast<Eigen::Index>(positions_mm_.size());
  const auto columns = static_cast<Eigen::Index>(kParametersPerContact * contacts.size());
  TaxelResponse response{Eigen::VectorXd::Zero(taxels), Eigen::MatrixXd::Zero(taxels, with_derivatives ? columns : 0)};
  for (Eigen::Index t = 0; t < taxels; ++t) {
    const Eigen::Vector2d& centre = positions_mm_[static_cast<std::size_t>(t)];
    std::vector<std::size_t> near;
    for (std::size_t c = 0; c < contacts.size(); ++c) {
      if ((centre - contacts[c].position_mm).norm() < profiles[c].reach_mm + disc_radius_mm_) near.push_back(c);
    }
    if (near.empty()) continue;
    for (const DiscPoint& p : disc_points()) {
      const Eigen::Vector2d point = centre + disc_radius_mm_ * p.position;
      double u = 0.0;
      for (const std::size_t c : near) u += profiles[c].displacement.at((point - contacts[c].position_mm).norm());
      if (u >= 0.999 * h) return std::nullopt;
      response.values[t] += p.weight * u / (h - u);
      if (!with_derivatives) continue;
      const double slope = p.weight * h / ((h - u) * (h - u));
      for (const std::size_t c : near) {
        const Eigen::Vector2d offset = point - contacts[c].position_mm;
        const double r = offset.norm();
        const double gradient = (profiles[c].displacement.at(r + kSampleStep_mm) -
                                 profiles[c].displacement.at(std::abs(r - kSampleStep_mm))) /
                                (2.0 * kSampleStep_mm);
        const Eigen::Vector2d by_position =
            r > 1e-9 ? Eigen::Vector2d(-gradient * offset / r) : Eigen::Vector2d::Zero();
        const auto first = static_cast<Eigen::Index>(kParametersPerContact * c);
        response.derivatives(t, first) += slope * by_position.x();
        response.derivatives(t, first + 1) += slope * by_position.y();
        response.derivatives(t, first + 2) +=
            slope * (profiles[c].more_force.at(r) - profiles[c].less_force.at(r)) / (2.0 * kLogStep);
        response.derivatives(t, first + 3) +=
            slope * (profiles[c].more_radius.at(r) - profiles[c].less_radius.at(r)) / (2.0 * kLogStep);
      }
    }
  }
  return response;
}

}  // namespace triskin::mechanics
