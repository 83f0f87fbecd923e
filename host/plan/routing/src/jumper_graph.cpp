// SPDX-License-Identifier: GPL-3.0-or-later
#include "jumper_graph.hpp"

#include <cmath>

namespace triskin::routing {

IntegerPrice::IntegerPrice(const Price& price)
    : part(std::llround(price.controller * 1e6) * 4096 + 64), jumper(std::llround(price.jumper * 1e6) * 4096 + 1) {}

JumperGraph jumper_graph(const ModuleGraph& with, const ModuleGraph& without, const Numbers& nodes) {
  JumperGraph g{localize(with, nodes), localize(without, nodes), {}};
  g.over_jumper.resize(g.joined.neighbour.size());
  for (std::size_t v = 0; v < g.over_jumper.size(); ++v) {
    for (std::size_t s = 0; s < 3; ++s)
      g.over_jumper[v][s] = g.joined.neighbour[v][s] >= 0 && g.apart.neighbour[v][s] < 0;
  }
  return g;
}

JumperGraph part_of_graph(const JumperGraph& g, const Numbers& nodes) {
  Numbers local(g.joined.node.size(), -1);
  for (std::size_t k = 0; k < nodes.size(); ++k) local[nodes[k]] = static_cast<int>(k);
  JumperGraph part;
  part.joined.node = part.apart.node = nodes;
  for (const int v : nodes) {
    part.joined.neighbour.push_back(g.joined.neighbour[v]);
    part.apart.neighbour.push_back(g.apart.neighbour[v]);
    part.over_jumper.push_back({});
    for (std::size_t s = 0; s < 3; ++s) {
      for (int* w : {&part.joined.neighbour.back()[s], &part.apart.neighbour.back()[s]}) *w = *w < 0 ? -1 : local[*w];
      part.over_jumper.back()[s] = part.joined.neighbour.back()[s] >= 0 && g.over_jumper[v][s];
    }
  }
  return part;
}

int jumpers_of(const JumperGraph& g, const Numbers& part_of, int parts) {
  Table<int, bool> seen(part_of.size(), false);
  Numbers queue;
  int pieces = 0;
  for (std::size_t start = 0; start < part_of.size(); ++start) {
    if (seen[start]) continue;
    ++pieces;
    seen[start] = true;
    queue.assign(1, static_cast<int>(start));
    for (std::size_t k = 0; k < queue.size(); ++k) {
      for (const int w : g.apart.neighbour[queue[k]]) {
        if (w < 0 || seen[w] || part_of[w] != part_of[start]) continue;
        seen[w] = true;
        queue.push_back(w);
      }
    }
  }
  return pieces - parts;
}

}  // namespace triskin::routing
