// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <array>
#include <map>
#include <random>
#include <set>
#include <vector>

#include "triskin/geometry/routing.hpp"
#include "triskin/model/design.hpp"

namespace triskin::test {

/// A random connected set of tiles on the plane, routed: a design without a mesh. Joints are those of the lattice, cycles included.
inline model::Design random_design(int modules, std::mt19937_64& random) {
  using Vertex = std::array<int, 2>;
  using Tile = std::array<int, 3>;  // i, j, up
  const auto corners = [](const Tile& t) {
    const auto [i, j, up] = t;
    return up != 0 ? std::array<Vertex, 3>{Vertex{i, j}, {i + 1, j}, {i, j + 1}} : std::array<Vertex, 3>{Vertex{i + 1, j}, {i + 1, j + 1}, {i, j + 1}};
  };
  const auto across = [](const Tile& t, int side) {
    const auto [i, j, up] = t;
    if (up != 0) return side == 0 ? Tile{i, j - 1, 0} : side == 1 ? Tile{i, j, 0} : Tile{i - 1, j, 0};
    return side == 0 ? Tile{i + 1, j, 1} : side == 1 ? Tile{i, j + 1, 1} : Tile{i, j, 1};
  };
  std::vector<Tile> tiles{{0, 0, 1}};
  std::map<Tile, int> number{{tiles[0], 0}};
  while (static_cast<int>(tiles.size()) < modules) {
    const Tile next = across(tiles[random() % tiles.size()], static_cast<int>(random() % 3));
    if (number.try_emplace(next, static_cast<int>(tiles.size())).second) tiles.push_back(next);
  }
  model::Design d;
  d.name = "random";
  d.source_file = "random.obj";
  d.surface.vertices = {{-2000, -2000, 0}, {2000, -2000, 0}, {2000, 2000, 0}, {-2000, 2000, 0}};
  d.surface.faces = {{0, 1, 2}, {0, 2, 3}};
  d.layout.islands = 1;
  d.layout.method = "surface";
  geometry::ModuleGraph graph;
  for (const Tile& t : tiles) {
    geometry::PlacedModule m;
    m.tile = {t[0], t[1], t[2] != 0};
    geometry::ModuleGraph::Node node;
    for (std::size_t k = 0; k < 3; ++k) {
      const auto [i, j] = corners(t)[k];
      m.corner_mm[k] = geometry::Vec3{30.0 * (i + 0.5 * j), geometry::kHeight_mm * j, 0.0};
      const auto other = number.find(across(t, static_cast<int>(k)));
      m.neighbour[k] = other == number.end() ? -1 : other->second;
      node.neighbour[k] = m.neighbour[k];
      node.border[k] = m.neighbour[k] < 0;
    }
    d.layout.modules.push_back(m);
    graph.nodes.push_back(node);
  }
  d.patches = geometry::route(graph).patches;
  d.design_id = model::design_id_of(d);
  return d;
}

}  // namespace triskin::test
