// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstdint>
#include <vector>

#include "triskin/hardware/scene.hpp"

namespace triskin::hardware {

/// A module's chip is in a patch, on a line, at an address.
struct ChipPlace {
  layout::PatchIndex patch = layout::PatchIndex::none();  ///< −1 means that the chip does not answer.
  int line = 0, address = 0;
  bool operator==(const ChipPlace&) const = default;
};

/// Each place of a chip applies from its time on. The first one starts at time 0.
struct PlaceFrom {
  std::uint64_t from_us = 0;
  ChipPlace place;
};
using ChipPlaces = std::vector<PlaceFrom>;

/// Returns the place at virtual time `at_us`. Cost: O(log places).
[[nodiscard]] ChipPlace place_at(const ChipPlaces& places, std::uint64_t at_us);

/// Returns the modules of the tree from `module` on, itself included; none of a patch gives the module alone.
[[nodiscard]] std::vector<design::RoutedModule> modules_from(const design::Design& design, layout::ModuleId module);

/// Returns the places of the chips by module, after the faults that remove, move and swap them. Cost: O(faults ·
/// modules).
[[nodiscard]] std::vector<ChipPlaces> chip_places(const Scene& scene);

}  // namespace triskin::hardware
