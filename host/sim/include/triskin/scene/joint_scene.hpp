// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "triskin/design/side_by_side.hpp"
#include "triskin/scene/scene.hpp"
#include "triskin/wire/bus_load.hpp"

namespace triskin::scene {

/// A cover on a simulated bus.
struct SimulatedCover {
  std::string name;  ///< It is unique on the robot, and the electrodes of the cover's modules are drawn from it.
  const design::Design* design;  ///< It has the node addresses of this bus (Design::node_addresses).
  /// They are indexed by patch; an id of zeros is fresh and drawn from name, design and `board_seed`.
  std::vector<wire::UniqueId> boards;
};

/// Several covers on one bus as one scene, in which nobody touches the skin and nothing is wrong.
struct JointScene {
  Scene scene;                               ///< Patches whose controllers hang on another bus are left out.
  std::vector<design::CoverOffset> offsets;  ///< Module m of cover c is module offsets[c].module + m of the scene.
};
/// Joins covers; each lies 10 m from the next, so that a finger on one reaches no other. Another cover, or a changed
/// one, leaves boards and electrodes of the others as they are. `board_seed`: as Scene::board_seed, of boards without a
/// number. Throws as design::side_by_side does. Cost: linear.
[[nodiscard]] JointScene join_covers(std::span<const SimulatedCover> covers, const wire::BitRates& rates,
                                     std::optional<std::uint64_t> board_seed = std::nullopt);

}  // namespace triskin::scene
