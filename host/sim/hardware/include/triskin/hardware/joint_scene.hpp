// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "triskin/design/side_by_side.hpp"
#include "triskin/hardware/scene.hpp"
#include "triskin/wire/bus_load.hpp"

namespace triskin::hardware {

struct SimulatedCover {
  /// The name is unique on the robot, and it determines the random electrodes of the cover's modules.
  std::string name;
  const design::Design* design;  ///< The design has the node addresses of this bus (Design::node_addresses).
  /// Ids are indexed by patch; an id of zeros means a new board, whose id is drawn from name, design and `board_seed`.
  std::vector<wire::UniqueId> boards;
  /// Contacts, faults, clocks and levels of the cover's modules and patches; null means that nobody touches it and
  /// nothing is broken. Its design is ignored.
  const Scene* scene = nullptr;
};

/// The scene joins several covers on one bus. Its expectations are empty.
struct JointScene {
  Scene scene;                     ///< Patches whose controllers are on another bus are left out, with their faults.
  std::vector<std::string> names;  ///< Names of the covers.
  std::vector<design::CoverOffset> offsets;  ///< Module m of cover c is module offsets[c].module + m of the scene.
};
/// Joins covers at distances of 10 m, so that a finger on one reaches no other. Adding or changing a cover does not
/// affect boards and electrodes of the others. `board_seed` is that of Scene::board_seed, for boards without a number.
/// Seed, hardware, pressure and effects are those of the first cover's scene, except for the bit rates. Throws
/// InputError for a fault between controllers on different buses, and as design::side_by_side does. Cost: linear.
[[nodiscard]] JointScene join_covers(std::span<const SimulatedCover> covers, const wire::BitRates& rates,
                                     std::optional<std::uint64_t> board_seed = std::nullopt);

}  // namespace triskin::hardware
