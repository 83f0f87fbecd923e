// SPDX-License-Identifier: GPL-3.0-or-later
#include "triskin/design/joint.hpp"

#include <algorithm>

#include "triskin/design/module_graph.hpp"

namespace triskin::design {

PortEnds joints_of(const Design& design, layout::PatchIndex patch_index, std::span<const int> rotations) {
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
      ends[k][static_cast<std::size_t>(port_at(static_cast<int>(k), side))] = {layout::TableRow{other},
                                                                               port_at(other, far_side)};
    }
  }
  return ends;
}

std::vector<std::array<ModuleEnd, layout::kPorts>> module_ends(const Design& design, std::span<const int> rotations) {
  const auto at = [](int k) { return static_cast<std::size_t>(k); };
  const std::vector<ModuleWiring> wiring = wiring_of(design);
  const auto port_at = [&](int module, int side) {
    return (side + 3 - (rotations.empty() ? wiring[at(module)].routed.rotation : rotations[at(module)])) % 3;
  };
  const auto has_cable = [&](int module, int side) {
    if (wiring[at(module)].patch < 0) return false;
    const Patch& p = design.patches[at(wiring[at(module)].patch)];
    return (p.entry == module && p.modules[0].rotation == side) ||
           (p.second_entry == module && p.second_entry_side == side);
  };
  std::vector<std::array<ModuleEnd, layout::kPorts>> ends(wiring.size());
  for (int m = 0; m < static_cast<int>(wiring.size()); ++m) {
    const std::array<int, 3> neighbour = joined_to(design.layout, m);
    for (int side = 0; side < 3; ++side) {
      const int other = neighbour[at(side)];
      if (other < 0 || has_cable(m, side)) continue;
      const std::array<int, 3> back = joined_to(design.layout, other);
      const int far_side = static_cast<int>(std::ranges::find(back, m) - back.begin());
      if (far_side == 3 || has_cable(other, far_side)) continue;
      ends[at(m)][at(port_at(m, side))] = {layout::ModuleId{other}, port_at(other, far_side)};
    }
  }
  return ends;
}

}  // namespace triskin::design
