// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>

#include "triskin/recording/messages.hpp"

namespace triskin::recording {
namespace {

bool belong_together(const PressedTaxel& a, const PressedTaxel& b) {
  return (a.position_mm - b.position_mm).norm() <= kContactReach_mm && a.normal.dot(b.normal) > 0.0;
}

// Removes the first taxel from `left`, together with all that are linked to it.
std::vector<PressedTaxel> take_region(std::vector<PressedTaxel>& left) {
  std::vector<PressedTaxel> region{left.front()};
  left.erase(left.begin());
  for (std::size_t at = 0; at < region.size(); ++at) {
    const auto linked =
        std::ranges::stable_partition(left, [&](const PressedTaxel& t) { return !belong_together(region[at], t); });
    region.insert(region.end(), linked.begin(), linked.end());
    left.erase(linked.begin(), linked.end());
  }
  return region;
}

Contact contact_of(std::vector<PressedTaxel> taxels, double taxel_area_mm2) {
  std::ranges::stable_sort(taxels, std::ranges::greater{}, &PressedTaxel::change_counts);
  Contact c;
  for (const PressedTaxel& t : taxels) {
    c.change_counts += t.change_counts;
    c.force_n += t.force_n;
    c.position_mm += t.change_counts * t.position_mm;
    c.normal += t.change_counts * t.normal;
  }
  c.position_mm /= c.change_counts;
  c.normal = c.normal.stableNormalized();
  c.area_mm2 = taxel_area_mm2 * static_cast<double>(taxels.size());
  c.taxels = std::move(taxels);
  return c;
}

}  // namespace

std::vector<Contact> gather_contacts(std::span<const PressedTaxel> taxels, double module_area_mm2) {
  std::vector<PressedTaxel> left;
  std::ranges::copy_if(taxels, std::back_inserter(left), [](const PressedTaxel& t) {
    return t.change_counts > 0.0 && layout::measures_pressure(static_cast<std::size_t>(t.taxel));
  });
  std::vector<Contact> contacts;
  while (!left.empty())
    contacts.push_back(contact_of(take_region(left), module_area_mm2 / layout::kPressureTaxelsPerModule));
  std::ranges::stable_sort(contacts, std::ranges::greater{}, &Contact::change_counts);
  return contacts;
}

}  // namespace triskin::recording
