// SPDX-License-Identifier: GPL-3.0-or-later
#include "triskin/mechanics/surface_contacts.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "contact_search.hpp"
#include "surface_layout.hpp"
#include "taxel_model.hpp"
#include "triskin/base/error.hpp"

namespace triskin::mechanics {
namespace {

constexpr double kPressedDeviations = 4.0;
constexpr int kMaxContactsOfGroup = 3;

using Points = std::span<const Eigen::Vector3d>;

void check(const SurfaceOptions& options) {
  if (!(options.noise_dc_over_c > 0.0) || !(options.disc_diameter_mm > 0.0) || !(options.max_link_mm > 0.0))
    throw InputError("contacts: noise, diameter of the discs and distance of neighbours have to be positive");
  if (options.max_contacts < 1) throw InputError("contacts: at least one contact has to be allowed");
}

TaxelGroup pressed_taxels(std::span<const double> values, double floor) {
  TaxelGroup pressed;
  for (std::size_t t = 0; t < values.size(); ++t) {
    if (values[t] > floor && std::isfinite(values[t])) pressed.push_back(t);
  }
  return pressed;
}

}  // namespace

std::vector<SurfaceContact> contacts_from_taxels(const ContactTable& table, Points positions_mm, Points normals,
                                                 std::span<const double> dc_over_c, const SurfaceOptions& options) {
  const SurfaceTaxels cover{positions_mm, normals, dc_over_c};
  check(cover);
  check(options);
  const double floor = kPressedDeviations * options.noise_dc_over_c;
  std::vector<SurfaceContact> contacts;
  for (const TaxelGroup& group : pressed_groups(cover, pressed_taxels(dc_over_c, floor), options.max_link_mm)) {
    const int rest = options.max_contacts - static_cast<int>(contacts.size());
    if (rest <= 0) break;
    const SurfaceLayout layout = laid_out(cover, group);
    const TaxelModel model(table, layout.places_mm, options.disc_diameter_mm / 2.0);
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
