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
  return graph;
}

}  // namespace triskin::design
