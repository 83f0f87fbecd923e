// SPDX-License-Identifier: GPL-3.0-or-later
#include "triskin/design/joint.hpp"

#include <algorithm>

#include "triskin/design/module_graph.hpp"

namespace triskin::design {

PortEnds joints_of(const Design& design, int patch_index, std::span<const int> rotations) {
  const auto& routed = design.patches.at(static_cast<std::size_t>(patch_index)).modules;
  const auto row_of = [&](int node) {
    const auto found = std::ranges::find(routed, node, &RoutedModule::node);
    return found == routed.end() ? -1 : static_cast<int>(found - routed.begin());
  };
  const auto port_at = [&](int row, int side) {
    const auto k = static_cast<std::size_t>(row);
    return (side + 3 - (rotations.empty() ? routed[k].rotation : rotations[k])) % 3;
  };
  PortEnds ends(routed.size());
  for (std::size_t k = 0; k < routed.size(); ++k) {
    const std::array<int, 3> neighbour = joined_to(design.layout, routed[k].node);
    for (int side = 0; side < 3; ++side) {
      const int other =
          neighbour[static_cast<std::size_t>(side)] < 0 ? -1 : row_of(neighbour[static_cast<std::size_t>(side)]);
      if (other < 0 || (k == 0 && side == routed[0].rotation)) continue;
      const std::array<int, 3> back = joined_to(design.layout, routed[static_cast<std::size_t>(other)].node);
      const auto far = std::ranges::find(back, routed[k].node);
      const int far_side = static_cast<int>(far - back.begin());
      if (far == back.end() || (other == 0 && far_side == routed[0].rotation)) continue;
      ends[k][static_cast<std::size_t>(port_at(static_cast<int>(k), side))] = {other, port_at(other, far_side)};
    }
  }
  return ends;
}

}  // namespace triskin::design
