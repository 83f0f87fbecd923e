// SPDX-License-Identifier: GPL-3.0-or-later
#include "chip_places.hpp"

#include <algorithm>
#include <iterator>
#include <set>

#include "change_times.hpp"

namespace triskin::hardware {
namespace {

// Removes chips after all others have their places, whatever the order of faults in the scene.
void remove_from(std::vector<ChipPlace>& places, const Scene& scene, std::uint64_t at_us) {
  for (const Fault& f : scene.faults) {
    if (!is_present(f, at_us)) continue;
    if (f.kind == FaultKind::kRemovedChip)
      places[static_cast<std::size_t>(f.module)].patch = layout::PatchIndex::none();
    if (f.kind != FaultKind::kOpenLine) continue;
    for (const design::RoutedModule& m : modules_from(scene.design, f.module)) {
      if (m.line == f.line) places[static_cast<std::size_t>(m.node)].patch = layout::PatchIndex::none();
    }
  }
}

bool moves_chips(const Fault& f) {
  return f.module >= 0 && (f.kind == FaultKind::kRemovedChip || f.kind == FaultKind::kOpenLine ||
                           f.kind == FaultKind::kMovedChip || f.kind == FaultKind::kSwappedChips);
}

void apply_to(std::vector<ChipPlace>& places, const Fault& f) {
  ChipPlace& place = places[static_cast<std::size_t>(f.module)];
  if (f.kind == FaultKind::kMovedChip) place.line = f.line, place.address = f.address;
  if (f.kind == FaultKind::kSwappedChips) std::swap(place, places[static_cast<std::size_t>(f.other)]);
}

}  // namespace

std::vector<design::RoutedModule> modules_from(const design::Design& design, layout::ModuleId module) {
  std::vector<design::RoutedModule> found;
  for (const design::Patch& patch : design.patches) {
    for (const design::RoutedModule& m : patch.modules) {  // Parents precede children.
      if (m.node == module || std::ranges::count(found, m.parent, &design::RoutedModule::node) > 0) found.push_back(m);
    }
  }
  return found;
}

ChipPlace place_at(const ChipPlaces& places, std::uint64_t at_us) {
  return std::prev(std::ranges::upper_bound(places, at_us, {}, &PlaceFrom::from_us))->place;
}

std::vector<ChipPlaces> chip_places(const Scene& scene) {
  std::set<std::uint64_t> times = change_times_us(scene, moves_chips);
  times.insert(0);
  std::vector<ChipPlace> designed;
  for (const auto& w : design::wiring_of(scene.design)) designed.push_back({w.patch, w.routed.line, w.routed.address});
  std::vector<ChipPlaces> all(designed.size());
  for (const std::uint64_t at_us : times) {
    std::vector<ChipPlace> places = designed;
    for (const Fault& f : scene.faults) {
      if (moves_chips(f) && is_present(f, at_us)) apply_to(places, f);
    }
    remove_from(places, scene, at_us);
    for (std::size_t m = 0; m < places.size(); ++m) {
      if (all[m].empty() || all[m].back().place != places[m]) all[m].push_back({at_us, places[m]});
    }
  }
  return all;
}

}  // namespace triskin::hardware
