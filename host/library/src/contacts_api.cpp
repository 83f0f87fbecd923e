// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <limits>
#include <vector>

#include "guarded.hpp"
#include "triskin/design/calibration.hpp"
#include "triskin/design/outline.hpp"
#include "triskin/recording/messages.hpp"
#include "triskin/skin/touch_map.hpp"

namespace triskin::library {
namespace {

using recording::Contact;
using recording::PressedTaxel;

design::Vec3 vector_at(const double* numbers, std::size_t taxel) {
  return {numbers[3 * taxel], numbers[3 * taxel + 1], numbers[3 * taxel + 2]};
}

// Returns the force of a taxel, or NaN if it has no calibration; NaN also makes the sum of its contact NaN.
double force_of(double change_counts, double counts_per_kpa, double area_mm2) {
  return counts_per_kpa > 0.0 ? change_counts / counts_per_kpa * area_mm2 * design::kNewtonPerKpaMm2
                              : std::numeric_limits<double>::quiet_NaN();
}

triskin_contact contact_of(const Contact& c, bool has_forces) {
  triskin_contact out{};
  for (int axis = 0; axis < 3; ++axis) {
    out.position_mm[axis] = c.position_mm[axis];
    out.normal[axis] = c.normal[axis];
  }
  out.change_counts = c.change_counts;
  out.force_n = has_forces ? c.force_n : std::numeric_limits<double>::quiet_NaN();
  out.area_mm2 = c.area_mm2;
  out.module = c.taxels.front().module;
  out.taxel = c.taxels.front().taxel;
  out.taxels = static_cast<std::int32_t>(c.taxels.size());
  return out;
}

}  // namespace
}  // namespace triskin::library

triskin_status triskin_contacts(const double* xyz_mm, const double* normals, const double* change_counts,
                                const double* counts_per_kpa, const double* taxel_area_mm2, size_t module_count,
                                triskin_contact* contacts, size_t capacity, size_t* count) {
  using namespace triskin::library;
  return guarded([&] {
    require(xyz_mm != nullptr && normals != nullptr && change_counts != nullptr && count != nullptr,
            "triskin_contacts: an argument is NULL");
    require((counts_per_kpa == nullptr) == (taxel_area_mm2 == nullptr),
            "triskin_contacts: forces need both counts_per_kpa and taxel_area_mm2");
    require(contacts != nullptr || capacity == 0, "triskin_contacts: contacts is NULL, and capacity is not 0");
    std::vector<PressedTaxel> pressed;
    for (std::size_t n = 0; n < module_count * TRISKIN_TAXELS; ++n) {
      if (!(change_counts[n] >= triskin::device::TouchMap::kPressed_counts)) continue;
      const std::size_t module = n / TRISKIN_TAXELS;
      const double force_n =
          counts_per_kpa == nullptr ? 0.0 : force_of(change_counts[n], counts_per_kpa[n], taxel_area_mm2[module]);
      pressed.push_back({static_cast<int>(module), static_cast<int>(n % TRISKIN_TAXELS), change_counts[n],
                         vector_at(xyz_mm, n), vector_at(normals, n), force_n});
    }
    const std::vector<Contact> found = triskin::recording::gather_contacts(pressed, triskin::design::kModuleArea_mm2);
    *count = found.size();
    for (std::size_t k = 0; k < std::min(capacity, found.size()); ++k)
      contacts[k] = contact_of(found[k], counts_per_kpa != nullptr);
    return TRISKIN_OK;
  });
}
