// SPDX-License-Identifier: GPL-3.0-or-later
#include "taxel_model.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "disc_points.hpp"
#include "triskin/base/error.hpp"
#include "value_between.hpp"

namespace triskin::mechanics {
namespace {

constexpr double kSampleStep_mm = 0.05;
// Farther from its edge than this many thicknesses, the effect of a contact is below 0.1 % of its peak.
constexpr double kReachThicknesses = 8.0;
// Displacements below this fraction of the peak are left out, because the table is less exact than that.
constexpr double kMinShare = 1e-5;
// At this distance from its edge, in thicknesses, a contact bends the surface only gently.
constexpr double kSmoothThicknesses = 0.3;
constexpr double kLogStep = 1e-3;
// The copies of a tempered chain return to the profiles of their contacts after every refused step.
constexpr std::size_t kRemembered = 64;
// This near to the axis the displacement has no slope.
constexpr double kCentre_mm = 1e-9;
constexpr double kMaxIndentationShare = 0.999;

Contact press_tip(const ContactTable& table, double log_force, double log_radius) {
  return table.press({Shape::kSphere, std::exp(log_radius)}, std::exp(log_force));
}

}  // namespace

SampledProfile::SampledProfile(const ContactField& field, double reach_mm) : step_(kSampleStep_mm) {
  const int count = static_cast<int>(std::ceil(reach_mm / step_)) + 1;
  values_.reserve(static_cast<std::size_t>(count));
  for (int k = 0; k < count; ++k) values_.push_back(field.displacement_mm(k * step_));
  while (values_.size() > 1 && std::abs(values_.back()) < kMinShare * values_.front()) values_.pop_back();
}

double SampledProfile::at(double r) const {
  return value_between(values_, r / step_);
}

// Gives the displacement of one contact and its central differences by ln F and ln R.
struct TaxelModel::Profiles {
  double log_force, log_radius;
  bool has_derivatives;
  SampledProfile displacement, more_force, less_force, more_radius, less_radius;
  double contact_radius_mm = 0.0, reach_mm = 0.0;
  Eigen::RowVector2d radius_slope_mm = Eigen::RowVector2d::Zero();
};

TaxelModel::TaxelModel(const ContactTable& table, std::vector<Eigen::Vector2d> positions_mm, double disc_radius_mm)
    : table_(table), positions_mm_(std::move(positions_mm)), disc_radius_mm_(disc_radius_mm) {}

TaxelModel::SharedProfiles TaxelModel::profiles_of(const FitContact& contact, bool with_derivatives) const {
  const double f = contact.log_force, r = contact.log_radius;
  for (const SharedProfiles& p : recent_) {
    if (p->log_force == f && p->log_radius == r && (p->has_derivatives || !with_derivatives)) return p;
  }
  const Contact pressed = press_tip(table_, f, r);
  const double reach = pressed.contact_radius_mm + kReachThicknesses * table_.layer().thickness_mm;
  const auto sample = [&](const Contact& c) { return SampledProfile(*c.field, reach); };
  auto profiles = std::make_shared<Profiles>(Profiles{f, r, with_derivatives, sample(pressed), {}, {}, {}, {}});
  profiles->contact_radius_mm = pressed.contact_radius_mm;
  profiles->reach_mm = profiles->displacement.reach_mm();
  if (with_derivatives) {
    const Contact more_force = press_tip(table_, f + kLogStep, r), less_force = press_tip(table_, f - kLogStep, r);
    const Contact more_radius = press_tip(table_, f, r + kLogStep), less_radius = press_tip(table_, f, r - kLogStep);
    profiles->more_force = sample(more_force);
    profiles->less_force = sample(less_force);
    profiles->more_radius = sample(more_radius);
    profiles->less_radius = sample(less_radius);
    profiles->radius_slope_mm << more_force.contact_radius_mm - less_force.contact_radius_mm,
        more_radius.contact_radius_mm - less_radius.contact_radius_mm;
    profiles->radius_slope_mm /= 2.0 * kLogStep;
  }
  recent_.push_front(profiles);
  if (recent_.size() > kRemembered) recent_.pop_back();
  return profiles;
}

// Adds one point of a taxel's disc to its value and derivatives; returns false if the layer is pressed to its base.
class TaxelModel::DiscSum {
 public:
  DiscSum(double thickness_mm, std::span<const FitContact> contacts, const std::vector<SharedProfiles>& profiles,
          TaxelResponse& response)
      : thickness_mm_(thickness_mm), contacts_(contacts), profiles_(profiles), response_(response) {}

  bool add_taxel(Eigen::Index taxel, const Eigen::Vector2d& centre, double disc_radius_mm) {
    near_.clear();
    bool is_smooth = true;
    for (std::size_t c = 0; c < contacts_.size(); ++c) {
      const double distance = (centre - contacts_[c].position_mm).norm() - disc_radius_mm;
      if (distance < profiles_[c]->reach_mm) near_.push_back(c);
      is_smooth = is_smooth && distance > profiles_[c]->contact_radius_mm + kSmoothThicknesses * thickness_mm_;
    }
    if (near_.empty()) return true;
    const std::vector<DiscPoint>& points = is_smooth ? coarse_disc_points() : disc_points();
    return std::all_of(points.begin(), points.end(), [&](const DiscPoint& p) {
      return add_point(taxel, centre + disc_radius_mm * p.position, p.weight);
    });
  }

 private:
  bool add_point(Eigen::Index taxel, const Eigen::Vector2d& point, double weight) {
    const double h = thickness_mm_;
    double u = 0.0;
    for (const std::size_t c : near_) u += profiles_[c]->displacement.at((point - contacts_[c].position_mm).norm());
    if (u >= kMaxIndentationShare * h) return false;
    response_.values[taxel] += weight * u / (h - u);
    if (response_.derivatives.size() == 0) return true;
    const double slope = weight * h / ((h - u) * (h - u));
    for (const std::size_t c : near_) add_derivatives(taxel, c, point - contacts_[c].position_mm, slope);
    return true;
  }
  void add_derivatives(Eigen::Index taxel, std::size_t contact, const Eigen::Vector2d& offset, double slope) {
    const Profiles& p = *profiles_[contact];
    const double r = offset.norm();
    const double gradient = (p.displacement.at(r + kSampleStep_mm) - p.displacement.at(std::abs(r - kSampleStep_mm))) /
                            (2.0 * kSampleStep_mm);
    auto row = response_.derivatives.block<1, kParametersPerContact>(
        taxel, static_cast<Eigen::Index>(kParametersPerContact * contact));
    if (r > kCentre_mm) row.head<2>() -= slope * gradient / r * offset.transpose();
    row[2] += slope * (p.more_force.at(r) - p.less_force.at(r)) / (2.0 * kLogStep);
    row[3] += slope * (p.more_radius.at(r) - p.less_radius.at(r)) / (2.0 * kLogStep);
  }

  double thickness_mm_;
  std::span<const FitContact> contacts_;
  const std::vector<SharedProfiles>& profiles_;
  TaxelResponse& response_;
  std::vector<std::size_t> near_;
};

std::optional<TaxelResponse> TaxelModel::respond(std::span<const FitContact> contacts, bool with_derivatives) const {
  std::vector<SharedProfiles> profiles;
  try {
    for (const FitContact& c : contacts) profiles.push_back(profiles_of(c, with_derivatives));
  } catch (const InputError&) {
    return std::nullopt;
  }
  const auto taxels = static_cast<Eigen::Index>(positions_mm_.size());
  const auto columns = static_cast<Eigen::Index>(kParametersPerContact * contacts.size());
  const auto count = static_cast<Eigen::Index>(contacts.size());
  TaxelResponse response{Eigen::VectorXd::Zero(taxels), Eigen::MatrixXd::Zero(taxels, with_derivatives ? columns : 0),
                         Eigen::VectorXd(count), Eigen::MatrixX2d(count, 2)};
  for (Eigen::Index c = 0; c < count; ++c) {
    response.contact_radii_mm[c] = profiles[static_cast<std::size_t>(c)]->contact_radius_mm;
    response.radius_slopes_mm.row(c) = profiles[static_cast<std::size_t>(c)]->radius_slope_mm;
  }
  DiscSum sum(table_.layer().thickness_mm, contacts, profiles, response);
  for (Eigen::Index t = 0; t < taxels; ++t) {
    if (!sum.add_taxel(t, positions_mm_[static_cast<std::size_t>(t)], disc_radius_mm_)) return std::nullopt;
  }
  return response;
}

}  // namespace triskin::mechanics
