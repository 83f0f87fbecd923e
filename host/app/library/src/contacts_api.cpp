// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <vector>

#include "guarded.hpp"
#include "triskin/design/outline.hpp"
#include "triskin/layout/module.hpp"
#include "triskin/skin/skin_contacts.hpp"

namespace triskin::library {
namespace {

std::vector<design::Vec3> vectors_of(const double* numbers, std::size_t count) {
  std::vector<design::Vec3> vectors;
  for (std::size_t n = 0; n < count; ++n) vectors.emplace_back(numbers[3 * n], numbers[3 * n + 1], numbers[3 * n + 2]);
  return vectors;
}

triskin_contact contact_of(const skin::SkinContact& c) {
  triskin_contact out{};
  for (int axis = 0; axis < 3; ++axis) {
    out.position_mm[axis] = c.position_mm[axis];
    out.normal[axis] = c.normal[axis];
  }
  out.change_counts = c.change_counts;
  out.force_n = c.force_n;
  out.area_mm2 = c.area_mm2;
  out.module = c.taxels.front().module;
  out.taxel = c.taxels.front().taxel;
  out.taxels = static_cast<std::int32_t>(c.taxels.size());
  out.position_sd_mm = c.position_sd_mm;
  out.force_sd_n = c.force_sd_n;
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
    const std::size_t n = module_count * TRISKIN_TAXELS;
    constexpr double kEqualShare_mm2 = triskin::design::kModuleArea_mm2 / triskin::layout::kPressureTaxelsPerModule;
    triskin::skin::ContactFrame frame{vectors_of(xyz_mm, n),
                                      vectors_of(normals, n),
                                      {change_counts, change_counts + n},
                                      {},
                                      std::vector<double>(module_count, kEqualShare_mm2)};
    if (counts_per_kpa != nullptr) frame.counts_per_kpa.assign(counts_per_kpa, counts_per_kpa + n);
    for (std::size_t m = 0; m < module_count && taxel_area_mm2 != nullptr; ++m) {
      if (taxel_area_mm2[m] > 0.0) frame.taxel_area_mm2[m] = taxel_area_mm2[m];
    }
    const auto found = triskin::skin::contacts_of(frame);
    *count = found.size();
    for (std::size_t k = 0; k < std::min(capacity, found.size()); ++k) contacts[k] = contact_of(found[k]);
    return TRISKIN_OK;
  });
}
