// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>
#include <set>

#include "local_graph.hpp"

namespace triskin::geometry {
namespace {

using Vec = std::array<double, 3>;

Vec minus(const Vec& a, const Vec& b) {
  return {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
}
double dot(const Vec& a, const Vec& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

struct FreeSide {
  int node, side;
  Vec place, outward;
};

// Outward directions more than 120° apart: the sides face each other across a seam.
bool face_each_other(const FreeSide& a, const FreeSide& b) {
  return dot(a.outward, b.outward) < -0.5 * std::sqrt(dot(a.outward, a.outward) * dot(b.outward, b.outward));
}

}  // namespace

std::vector<Jumper> find_jumpers(const ModuleGraph& graph,
                                 const std::vector<std::array<std::array<double, 3>, 3>>& side_mm,
                                 double max_length_mm) {
  std::vector<FreeSide> sides;
  for (std::size_t v = 0; v < graph.nodes.size(); ++v) {
    for (std::size_t s = 0; s < 3; ++s) {
      if (graph.nodes[v].neighbour[s] >= 0) continue;
      sides.push_back(
          {static_cast<int>(v), static_cast<int>(s), side_mm[v][s], minus(side_mm[v][s], graph.nodes[v].center_mm)});
    }
  }
  std::ranges::stable_sort(sides, {}, [](const FreeSide& f) { return f.place[0]; });
  std::vector<Jumper> candidates;
  for (std::size_t a = 0; a < sides.size(); ++a) {
    for (std::size_t b = a + 1; b < sides.size() && sides[b].place[0] - sides[a].place[0] <= max_length_mm; ++b) {
      const Vec d = minus(sides[b].place, sides[a].place);
      const double length = std::sqrt(dot(d, d));
      if (graph.nodes[at(sides[a].node)].island == graph.nodes[at(sides[b].node)].island) continue;
      if (length > max_length_mm || !face_each_other(sides[a], sides[b])) continue;
      candidates.push_back({{sides[a].node, sides[b].node}, {sides[a].side, sides[b].side}, length});
    }
  }
  std::ranges::stable_sort(candidates, {}, [](const Jumper& j) { return std::tuple(j.length_mm, j.node, j.side); });
  std::set<std::array<int, 2>> used_sides, used_pairs;
  std::vector<Jumper> chosen;
  for (const Jumper& j : candidates) {
    const std::array<int, 2> first{j.node[0], j.side[0]}, second{j.node[1], j.side[1]};
    const std::array<int, 2> pair{std::min(j.node[0], j.node[1]), std::max(j.node[0], j.node[1])};
    if (used_sides.contains(first) || used_sides.contains(second) || used_pairs.contains(pair)) continue;
    used_sides.insert({first, second});
    used_pairs.insert(pair);
    chosen.push_back(j);
  }
  return chosen;
}

ModuleGraph with_jumpers(ModuleGraph graph, const std::vector<Jumper>& jumpers) {
  for (const Jumper& j : jumpers) {
    for (std::size_t k = 0; k < 2; ++k) {
      ModuleGraph::Node& node = graph.nodes[at(j.node[k])];
      node.neighbour[at(j.side[k])] = j.node[1 - k];
      node.border[at(j.side[k])] = false;
    }
  }
  return graph;
}

}  // namespace triskin::geometry
