// SPDX-License-Identifier: GPL-3.0-or-later
#include "triskin/design/module_graph.hpp"

namespace triskin::design {

ModuleGraph graph_of(const ModuleLayout& layout) {
  ModuleGraph graph;
  for (const PlacedModule& m : layout.modules) {
    ModuleGraph::Node node;
    node.neighbour = m.neighbour;
    for (std::size_t s = 0; s < 3; ++s) node.border[s] = m.neighbour[s] < 0;
    node.island = m.island;
    const Vec3 center = (m.corner_mm[0] + m.corner_mm[1] + m.corner_mm[2]) / 3.0;
    node.center_mm = {center.x(), center.y(), center.z()};
    graph.nodes.push_back(node);
  }
  return with_jumpers(std::move(graph), layout.jumpers);
}

ModuleGraph with_jumpers(ModuleGraph graph, const std::vector<Jumper>& jumpers) {
  for (const Jumper& j : jumpers) {
    for (std::size_t k = 0; k < 2; ++k) {
      ModuleGraph::Node& node = graph.nodes.at(static_cast<std::size_t>(j.node[k]));
      node.neighbour.at(static_cast<std::size_t>(j.side[k])) = j.node[1 - k];
      node.border.at(static_cast<std::size_t>(j.side[k])) = false;
    }
  }
  return graph;
}

std::array<int, 3> joined_to(const ModuleLayout& layout, int id) {
  std::array<int, 3> joined = layout.modules.at(static_cast<std::size_t>(id)).neighbour;
  for (const Jumper& j : layout.jumpers) {
    for (std::size_t k = 0; k < 2; ++k) {
      if (j.node[k] == id) joined.at(static_cast<std::size_t>(j.side[k])) = j.node[1 - k];
    }
  }
  return joined;
}

}  // namespace triskin::design
