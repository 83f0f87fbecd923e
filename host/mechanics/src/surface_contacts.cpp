// SPDX-License-Identifier: GPL-3.0-or-later
#include "triskin/mechanics/surface_contacts.hpp"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "contact_search.hpp"
#include "taxel_model.hpp"
#include "triskin/base/error.hpp"

namespace triskin::mechanics {
namespace {

constexpr double kPressedDeviations = 4.0;
// Taxels about a group show where nothing presses; farther ones add no information.
constexpr double kSurroundings_mm = 10.0;
// Taxels whose normals differ by nearly a right angle or more are on another side of the part.
constexpr double kMinFacing = 0.2;
constexpr int kMaxContactsOfGroup = 3;

using Points = std::span<const Eigen::Vector3d>;
using Group = std::vector<std::size_t>;

struct Cover {
  Points positions, normals;
  std::span<const double> values;
};

void check(const Cover& cover, const SurfaceOptions& options) {
  if (cover.normals.size() != cover.positions.size() || cover.values.size() != cover.positions.size())
    throw InputError(fmt::format("contacts: {} positions, {} normals and {} values; give one of each for every taxel",
                                 cover.positions.size(), cover.normals.size(), cover.values.size()));
  for (std::size_t t = 0; t < cover.normals.size(); ++t) {
    if (!(std::abs(cover.normals[t].norm() - 1.0) < 1e-3) || !cover.positions[t].allFinite())
      throw InputError(fmt::format("contacts: taxel {} has no finite position or no normal of length 1", t));
  }
  if (!(options.noise_dc_over_c > 0.0) || !(options.disc_diameter_mm > 0.0) || !(options.max_link_mm > 0.0))
    throw InputError("contacts: noise, diameter of the discs and distance of neighbours have to be positive");
  if (options.max_contacts < 1) throw InputError("contacts: at least one contact has to be allowed");
}

// Returns the volume by which the taxels of a group are pressed in, in thicknesses; it is proportional to the force
// (∫ u dA = F·h/K).
double volume_of(const Cover& cover, const Group& group) {
  double sum = 0.0;
  for (const std::size_t t : group) sum += cover.values[t] / (1.0 + cover.values[t]);
  return sum;
}

// Groups connected pressed taxels, each group from its strongest taxel on; the group that is pressed most comes first.
std::vector<Group> pressed_groups(const Cover& cover, const SurfaceOptions& options) {
  Group pressed;
  for (std::size_t t = 0; t < cover.values.size(); ++t) {
    if (cover.values[t] > kPressedDeviations * options.noise_dc_over_c && std::isfinite(cover.values[t]))
      pressed.push_back(t);
  }
  std::sort(pressed.begin(), pressed.end(),
            [&](std::size_t a, std::size_t b) { return cover.values[a] > cover.values[b]; });
  std::vector<Group> groups;
  std::vector<bool> is_taken(cover.values.size(), false);
  for (const std::size_t first : pressed) {
    if (is_taken[first]) continue;
    Group group = {first};
    is_taken[first] = true;
    for (std::size_t k = 0; k < group.size(); ++k) {
      for (const std::size_t t : pressed) {
        const bool is_near = (cover.positions[t] - cover.positions[group[k]]).norm() <= options.max_link_mm;
        if (is_taken[t] || !is_near || cover.normals[t].dot(cover.normals[group[k]]) < kMinFacing) continue;
        is_taken[t] = true;
        group.push_back(t);
      }
    }
    groups.push_back(std::move(group));
  }
  std::stable_sort(groups.begin(), groups.end(),
                   [&](const Group& a, const Group& b) { return volume_of(cover, a) > volume_of(cover, b); });
  return groups;
}

// Maps the cover to the tangent plane at the strongest taxel of a group.
class Chart {
 public:
  Chart(const Cover& cover, const Group& group) : origin_(cover.positions[group[0]]), axes_(Eigen::Matrix3d::Zero()) {
    Eigen::Vector3d normal = Eigen::Vector3d::Zero();
    for (const std::size_t t : group) normal += cover.values[t] * cover.normals[t];
    axes_.col(2) = normal.normalized();
    axes_.col(0) = axes_.col(2).unitOrthogonal();
    axes_.col(1) = axes_.col(2).cross(axes_.col(0));
  }
  [[nodiscard]] double facing(const Eigen::Vector3d& normal) const { return normal.dot(axes_.col(2)); }
  [[nodiscard]] const Eigen::Vector3d& origin() const { return origin_; }
  // Returns the place of a taxel in the plane: as far away as along an arc that turns by the angle between the normals.
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

// A group laid out in its plane, with the taxels about it.
struct Layout {
  Group taxels;
  std::vector<Eigen::Vector2d> places;
  Eigen::VectorXd values;
};

Layout laid_out(const Cover& cover, const Group& group) {
  const Chart chart(cover, group);
  Layout layout;
  std::vector<double> values;
  for (std::size_t t = 0; t < cover.positions.size(); ++t) {
    if (!std::isfinite(cover.values[t]) || chart.facing(cover.normals[t]) < kMinFacing) continue;
    const bool is_near = std::any_of(group.begin(), group.end(), [&](std::size_t g) {
      return (cover.positions[t] - cover.positions[g]).norm() <= kSurroundings_mm;
    });
    if (!is_near) continue;
    layout.taxels.push_back(t);
    layout.places.push_back(chart.laid_out(cover.positions[t], cover.normals[t], cover.normals[group[0]]));
    values.push_back(cover.values[t]);
  }
  layout.values = Eigen::Map<const Eigen::VectorXd>(values.data(), static_cast<Eigen::Index>(values.size()));
  return layout;
}

// Maps a contact back onto the cover: from the nearest taxel along its tangent plane, in the directions of its
// neighbours.
SurfaceContact on_cover(const Cover& cover, const Layout& layout, const ContactEstimate& found) {
  std::size_t nearest = 0;
  for (std::size_t k = 1; k < layout.places.size(); ++k) {
    if ((layout.places[k] - found.position_mm).norm() < (layout.places[nearest] - found.position_mm).norm())
      nearest = k;
  }
  // Fits the linear map from the plane to space to the taxels about it.
  Eigen::Matrix2d moments = 1e-9 * Eigen::Matrix2d::Identity();
  Eigen::Matrix<double, 3, 2> products = Eigen::Matrix<double, 3, 2>::Zero();
  const std::size_t centre = layout.taxels[nearest];
  Eigen::Vector3d normal = Eigen::Vector3d::Zero();
  for (std::size_t k = 0; k < layout.places.size(); ++k) {
    const Eigen::Vector2d step = layout.places[k] - layout.places[nearest];
    if (step.norm() > kSurroundings_mm) continue;
    moments += step * step.transpose();
    products += (cover.positions[layout.taxels[k]] - cover.positions[centre]) * step.transpose();
    const double distance = (layout.places[k] - found.position_mm).norm();
    normal += std::exp(-distance * distance / 18.0) * cover.normals[layout.taxels[k]];
  }
  SurfaceContact contact;
  contact.position_mm =
      cover.positions[centre] + products * moments.inverse() * (found.position_mm - layout.places[nearest]);
  contact.normal = normal.normalized();
  contact.position_sd_mm = found.position_sd_mm.norm() / std::numbers::sqrt2;
  contact.force_n = found.force_n;
  contact.force_sd_n = found.force_sd_n;
  contact.area_mm2 = std::numbers::pi * found.contact_radius_mm * found.contact_radius_mm;
  contact.tip_radius_mm = found.tip_radius_mm;
  return contact;
}

}  // namespace

std::vector<SurfaceContact> contacts_from_taxels(const ContactTable& table, Points positions_mm, Points normals,
                                                 std::span<const double> dc_over_c, const SurfaceOptions& options) {
  const Cover cover{positions_mm, normals, dc_over_c};
  check(cover, options);
  std::vector<SurfaceContact> contacts;
  for (const Group& group : pressed_groups(cover, options)) {
    const int rest = options.max_contacts - static_cast<int>(contacts.size());
    if (rest <= 0) break;
    const Layout layout = laid_out(cover, group);
    const TaxelModel model(table, layout.places, options.disc_diameter_mm / 2.0);
    InverseOptions inverse;
    inverse.noise_dc_over_c = options.noise_dc_over_c;
    inverse.max_contacts = std::min(rest, kMaxContactsOfGroup);
    for (const ContactEstimate& found : search_contacts(model, layout.values, inverse, Effort::kStream).contacts) {
      contacts.push_back(on_cover(cover, layout, found));
      contacts.back().pressed_taxels = static_cast<int>(group.size());
    }
  }
  std::sort(contacts.begin(), contacts.end(),
            [](const SurfaceContact& a, const SurfaceContact& b) { return a.force_n > b.force_n; });
  return contacts;
}

Wrench net_wrench(std::span<const SurfaceContact> contacts, const Eigen::Vector3d& about_mm) {
  Wrench wrench;
  Eigen::Vector3d force_variance = Eigen::Vector3d::Zero(), torque_variance = Eigen::Vector3d::Zero();
  for (const SurfaceContact& c : contacts) {
    const Eigen::Vector3d force = -c.force_n * c.normal, arm = c.position_mm - about_mm;
    wrench.force_n += force;
    wrench.torque_nmm += arm.cross(force);
    force_variance += (c.force_sd_n * c.normal).cwiseAbs2();
    torque_variance += (c.force_sd_n * arm.cross(c.normal)).cwiseAbs2();
    // A shift s along the cover changes the torque by s × force. Over both directions of the plane its squares add up
    // to the projection onto the plane.
    const double turn = c.position_sd_mm * c.force_n;
    torque_variance += turn * turn * (Eigen::Vector3d::Ones() - c.normal.cwiseAbs2());
  }
  wrench.force_sd_n = force_variance.cwiseSqrt();
  wrench.torque_sd_nmm = torque_variance.cwiseSqrt();
  return wrench;
}

}  // namespace triskin::mechanics
