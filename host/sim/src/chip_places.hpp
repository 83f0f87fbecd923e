// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstdint>
#include <vector>

#include "triskin/scene/scene.hpp"

namespace triskin::scene {

/// Where the chip of a module sits.
struct ChipPlace {
  int patch = -1;  ///< −1: nobody answers
  int line = 0, address = 0;
  bool operator==(const ChipPlace&) const = default;
};

/// The places of one chip: each counts from its time on. The first is that of time 0.
struct PlaceFrom {
  std::uint64_t from_us = 0;
  ChipPlace place;
};
using ChipPlaces = std::vector<PlaceFrom>;

/// Place at virtual time `at_us`. Cost: O(log places).
[[nodiscard]] ChipPlace place_at(const ChipPlaces& places, std::uint64_t at_us);

/// Places of the chips by module, after the faults that remove, move and swap them. Cost: O(faults · modules).
[[nodiscard]] std::vector<ChipPlaces> chip_places(const Scene& scene);

}  // namespace triskin::scene
