// SPDX-License-Identifier: GPL-3.0-or-later
#include "triskin/design/joint.hpp"

#include <algorithm>
#include <optional>

#include "triskin/design/module_graph.hpp"
#include "triskin/design/module_side.hpp"

namespace triskin::design {

namespace {

std::size_t index(int k) {
  return static_cast<std::size_t>(k);
}

// Returns the side of `module` across which `other` is joined to it, or nothing.
std::optional<int> side_towards(const ModuleLayout& layout, int module, int other) {
  const std::array<int, 3> joined = joined_to(layout, module);
  const auto side = std::ranges::find(joined, other);
  if (side == joined.end()) return std::nullopt;
  return static_cast<int>(side - joined.begin());
}

std::vector<int> designed_rotations(const std::vector<ModuleWiring>& wiring) {
  std::vector<int> rotations;
  for (const ModuleWiring& w : wiring) rotations.push_back(w.routed.rotation);
  return rotations;
}

// Returns true if the cable of an entry or of a second entry is soldered to this side.
bool has_cable(const Design& design, const ModuleWiring& wiring, int module, int side) {
  if (wiring.patch < 0) return false;
  const Patch& p = design.patches[index(wiring.patch)];
  return (p.entry == module && p.modules[0].rotation == side) ||
         (p.second_entry == module && p.second_entry_side == side);
}

}  // namespace

PortEnds joints_of(const Design& design, layout::PatchIndex patch_index, std::span<const int> rotations) {
  const auto& routed = design.patches.at(index(patch_index)).modules;
  const auto row_of = [&](int node) {
    const auto found = std::ranges::find(routed, node, &RoutedModule::node);
    return found == routed.end() ? -1 : static_cast<int>(found - routed.begin());
  };
  const auto port_at = [&](int row, int side) {
    return port_at_side(side, rotations.empty() ? routed[index(row)].rotation : rotations[index(row)]);
  };
  PortEnds ends(routed.size());
  for (int row = 0; row < static_cast<int>(routed.size()); ++row) {
    const int node = routed[index(row)].node;
    const std::array<int, 3> neighbour = joined_to(design.layout, node);
    for (int side = 0; side < 3; ++side) {
      const int other = neighbour[index(side)] < 0 ? -1 : row_of(neighbour[index(side)]);
      if (other < 0 || (row == 0 && side == routed[0].rotation)) continue;
      const auto far_side = side_towards(design.layout, routed[index(other)].node, node);
      if (!far_side || (other == 0 && *far_side == routed[0].rotation)) continue;
      ends[index(row)][index(port_at(row, side))] = {layout::TableRow{other}, port_at(other, *far_side)};
    }
  }
  return ends;
}

std::vector<std::array<ModuleEnd, layout::kPorts>> module_ends(const Design& design, std::span<const int> rotations) {
  const std::vector<ModuleWiring> wiring = wiring_of(design);
  std::vector<int> turned(rotations.begin(), rotations.end());
  if (turned.empty()) turned = designed_rotations(wiring);
  std::vector<std::array<ModuleEnd, layout::kPorts>> ends(wiring.size());
  for (int m = 0; m < static_cast<int>(wiring.size()); ++m) {
    const std::array<int, 3> neighbour = joined_to(design.layout, m);
    for (int side = 0; side < 3; ++side) {
      const int other = neighbour[index(side)];
      if (other < 0 || has_cable(design, wiring[index(m)], m, side)) continue;
      const auto far_side = side_towards(design.layout, other, m);
      if (!far_side || has_cable(design, wiring[index(other)], other, *far_side)) continue;
      ends[index(m)][index(port_at_side(side, turned[index(m)]))] = {layout::ModuleId{other},
                                                                     port_at_side(*far_side, turned[index(other)])};
    }
  }
  return ends;
}

}  // namespace triskin::design
