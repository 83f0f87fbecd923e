// SPDX-License-Identifier: GPL-3.0-or-later
#include "surface_layout.hpp"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "triskin/base/error.hpp"

namespace triskin::mechanics {
namespace {

// Taxels around a group show where nothing presses; more distant ones add no information.
constexpr double kSurroundings_mm = 10.0;
// Taxels that face away by about a right angle or more are on another side of the part.
constexpr double kMinFacing = 0.2;

double sum_of(const SurfaceTaxels& taxels, const TaxelGroup& group) {
  double sum = 0.0;
  for (const std::size_t t : group) sum += taxels.values[t];
  return sum;
}

// The chart is the tangent plane at the strongest taxel of a group.
class Chart {
 public:
  Chart(const SurfaceTaxels& cover, const TaxelGroup& group)
      : origin_(cover.positions[group[0]]), axes_(Eigen::Matrix3d::Zero()) {
    Eigen::Vector3d normal = Eigen::Vector3d::Zero();
    for (const std::size_t t : group) normal += cover.values[t] * cover.normals[t];
    axes_.col(2) = normal.normalized();
    axes_.col(0) = axes_.col(2).unitOrthogonal();
    axes_.col(1) = axes_.col(2).cross(axes_.col(0));
  }
  [[nodiscard]] double facing(const Eigen::Vector3d& normal) const { return normal.dot(axes_.col(2)); }
  [[nodiscard]] const Eigen::Vector3d& origin() const { return origin_; }
  // Lays a taxel out at the distance of an arc that turns by the angle between the normals.
  [[nodiscard]] Eigen::Vector2d laid_out(const Eigen::Vector3d& position, const Eigen::Vector3d& normal,
                                         const Eigen::Vector3d& normal_at_origin) const {
    const Eigen::Vector3d chord = position - origin_;
    const Eigen::Vector2d direction = axes_.leftCols<2>().transpose() * chord;
    const double half_turn = std::acos(std::clamp(normal.dot(normal_at_origin), -1.0, 1.0)) / 2.0;
    const double arc = half_turn > 1e-6 ? chord.norm() * half_turn / std::sin(half_turn) : chord.norm();
    return direction.norm() > 0.0 ? Eigen::Vector2d(arc * direction.normalized()) : direction;
  }

 private:
  Eigen::Vector3d origin_;
  Eigen::Matrix3d axes_;
};

}  // namespace

void check(const SurfaceTaxels& taxels) {
  if (taxels.normals.size() != taxels.positions.size() || taxels.values.size() != taxels.positions.size())
    throw InputError(fmt::format("contacts: {} positions, {} normals and {} values; give one of each for every taxel",
                                 taxels.positions.size(), taxels.normals.size(), taxels.values.size()));
  for (std::size_t t = 0; t < taxels.normals.size(); ++t) {
    if (!(std::abs(taxels.normals[t].norm() - 1.0) < 1e-3) || !taxels.positions[t].allFinite())
      throw InputError(fmt::format("contacts: taxel {} has no finite position or no normal of length 1", t));
  }
}

std::vector<TaxelGroup> pressed_groups(const SurfaceTaxels& taxels, TaxelGroup pressed, double max_link_mm) {
  std::sort(pressed.begin(), pressed.end(),
            [&](std::size_t a, std::size_t b) { return taxels.values[a] > taxels.values[b]; });
  std::vector<TaxelGroup> groups;
  std::vector<bool> is_taken(taxels.values.size(), false);
  for (const std::size_t first : pressed) {
    if (is_taken[first]) continue;
    TaxelGroup group = {first};
    is_taken[first] = true;
    for (std::size_t k = 0; k < group.size(); ++k) {
      for (const std::size_t t : pressed) {
        const bool is_near = (taxels.positions[t] - taxels.positions[group[k]]).norm() <= max_link_mm;
        if (is_taken[t] || !is_near || taxels.normals[t].dot(taxels.normals[group[k]]) < kMinFacing) continue;
        is_taken[t] = true;
        group.push_back(t);
      }
    }
    groups.push_back(std::move(group));
  }
  std::stable_sort(groups.begin(), groups.end(),
                   [&](const TaxelGroup& a, const TaxelGroup& b) { return sum_of(taxels, a) > sum_of(taxels, b); });
  return groups;
}

SurfaceLayout laid_out(const SurfaceTaxels& cover, const TaxelGroup& group) {
  const Chart chart(cover, group);
  SurfaceLayout layout;
  std::vector<double> values;
  for (std::size_t t = 0; t < cover.positions.size(); ++t) {
    if (!std::isfinite(cover.values[t]) || chart.facing(cover.normals[t]) < kMinFacing) continue;
    const bool is_near = std::any_of(group.begin(), group.end(), [&](std::size_t g) {
      return (cover.positions[t] - cover.positions[g]).norm() <= kSurroundings_mm;
    });
    if (!is_near) continue;
    layout.taxels.push_back(t);
    layout.places_mm.push_back(chart.laid_out(cover.positions[t], cover.normals[t], cover.normals[group[0]]));
    values.push_back(cover.values[t]);
  }
  layout.values = Eigen::Map<const Eigen::VectorXd>(values.data(), static_cast<Eigen::Index>(values.size()));
  return layout;
}

// Maps a contact back to the cover, from the nearest taxel along its tangent plane toward its neighbours.
SurfaceContact on_cover(const SurfaceTaxels& cover, const SurfaceLayout& layout, const ContactEstimate& found) {
  std::size_t nearest = 0;
  for (std::size_t k = 1; k < layout.places_mm.size(); ++k) {
    if ((layout.places_mm[k] - found.position_mm).norm() < (layout.places_mm[nearest] - found.position_mm).norm())
      nearest = k;
  }
  // We fit the linear map from the plane to space to the taxels around that one.
  Eigen::Matrix2d moments = 1e-9 * Eigen::Matrix2d::Identity();
  Eigen::Matrix<double, 3, 2> products = Eigen::Matrix<double, 3, 2>::Zero();
  const std::size_t centre = layout.taxels[nearest];
  Eigen::Vector3d normal = Eigen::Vector3d::Zero();
  for (std::size_t k = 0; k < layout.places_mm.size(); ++k) {
    const Eigen::Vector2d step = layout.places_mm[k] - layout.places_mm[nearest];
    if (step.norm() > kSurroundings_mm) continue;
    moments += step * step.transpose();
    products += (cover.positions[layout.taxels[k]] - cover.positions[centre]) * step.transpose();
    const double distance = (layout.places_mm[k] - found.position_mm).norm();
    normal += std::exp(-distance * distance / 18.0) * cover.normals[layout.taxels[k]];
  }
  SurfaceContact contact;
  contact.position_mm =
      cover.positions[centre] + products * moments.inverse() * (found.position_mm - layout.places_mm[nearest]);
  contact.normal = normal.normalized();
  contact.position_sd_mm = found.position_sd_mm.norm() / std::numbers::sqrt2;
  contact.force_n = found.force_n;
  contact.force_sd_n = found.force_sd_n;
  contact.area_mm2 = std::numbers::pi * found.contact_radius_mm * found.contact_radius_mm;
  contact.tip_radius_mm = found.tip_radius_mm;
  return contact;
}

}  // namespace triskin::mechanics
