// SPDX-License-Identifier: GPL-3.0-or-later
#include "kept_modules.hpp"

#include <map>

#include "triskin/base/disjoint_sets.hpp"

namespace triskin::lattice {

// Corners that modules share by their joints become one vertex, in the middle of them.
LatticeMesh net_of_kept(const mesh::Surface& surface, const CanonicalCopy& copy, const std::vector<PlacedModule>& kept,
                        double corner_cut_mm) {
  LatticeMesh net(surface.mesh().vertices, corner_cut_mm);
  const auto count = static_cast<int>(kept.size());
  std::vector<PlacedModule> modules;
  for (const PlacedModule& m : kept) modules.push_back(copy.carried_there(m));
  DisjointSets corners(3 * modules.size()), islands(modules.size());
  for (int k = 0; k < count; ++k) {
    for (int s = 0; s < 3; ++s) {
      const int other = modules[at(k)].neighbour[at(s)];
      if (other < 0) continue;
      const int t = across(modules[at(k)].tile, s).side;
      islands.join(k, other);
      corners.join(3 * k + s, 3 * other + (t + 1) % 3);
      corners.join(3 * k + (s + 1) % 3, 3 * other + t);
    }
  }
  std::map<int, std::vector<Vec3>> points;  // The key is the leader of the corners.
  for (int c = 0; c < 3 * count; ++c) points[corners.find(c)].push_back(modules[at(c / 3)].corner_mm[at(c % 3)]);
  std::map<int, int> vertex, island;
  for (int k = 0; k < count; ++k) {
    const PlacedModule& m = modules[at(k)];
    std::array<int, 3> of{};
    for (int c = 0; c < 3; ++c) {
      const int leader = corners.find(3 * k + c);
      const auto [found, is_new] = vertex.try_emplace(leader, -1);
      if (is_new) {
        Vec3 middle = Vec3::Zero();
        for (const Vec3& p : points[leader]) middle += p / static_cast<double>(points[leader].size());
        const auto label = tile_corner_index(m.tile, c);
        found->second = net.add_vertex(middle, surface.normal_at(surface.closest(middle)), label[0], label[1]);
      }
      of[at(c)] = found->second;
    }
    const auto [number, is_new] = island.try_emplace(islands.find(k), -1);
    if (is_new) number->second = net.new_island();
    net.pin(net.add_triangle(number->second, m.tile, of), m.corner_mm);
  }
  net.separate();
  return net;
}

// If a ring of modules is closed around a slit, the lattice joins both sides of the slit.
void restore_kept(const std::vector<PlacedModule>& kept, ModuleLayout& layout) {
  const auto count = static_cast<int>(kept.size());
  for (std::size_t k = 0; k < kept.size(); ++k) {
    PlacedModule& m = layout.modules[k];
    m.corner_mm = kept[k].corner_mm;
    m.kind = kept[k].kind;
    for (std::size_t s = 0; s < 3; ++s) {
      if (m.neighbour[s] < count) m.neighbour[s] = kept[k].neighbour[s];
    }
  }
}

}  // namespace triskin::lattice
