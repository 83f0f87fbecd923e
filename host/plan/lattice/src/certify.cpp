// SPDX-License-Identifier: GPL-3.0-or-later
#include "certify.hpp"

#include <vector>

#include "keep_limits.hpp"
#include "kept_modules.hpp"
#include "triskin/base/parallel.hpp"
#include "worst_places.hpp"

namespace triskin::lattice {
namespace {

// Makes a layout whose module k is triangle triangle_of[k] of the net.
ModuleLayout layout_of(const LatticeMesh& net, std::vector<int>& triangle_of) {
  ModuleLayout layout;
  layout.method = LayoutMethod::kSurface;
  layout.corner_cut_mm = net.corner_cut_mm();
  std::vector<int> number(net.island_sizes().size(), -1);  // Islands are numbered in the order of their first modules.
  int numbers = 0;
  layout.islands = net.islands();
  std::vector<int> index(net.triangles().size(), -1);
  for (std::size_t t = 0; t < net.triangles().size(); ++t) {
    if (net.triangles()[t].island < 0) continue;
    index[t] = static_cast<int>(layout.modules.size());
    triangle_of.push_back(static_cast<int>(t));
    PlacedModule m;
    int& island = number[at(net.triangles()[t].island)];
    if (island < 0) island = numbers++;
    m.island = island;
    m.tile = net.triangles()[t].tile;
    m.corner_mm = net.triangles()[t].rigid;
    layout.modules.push_back(m);
  }
  for (std::size_t t = 0; t < net.triangles().size(); ++t) {
    for (int s = 0; index[t] >= 0 && s < 3; ++s) {
      const int n = net.neighbour(static_cast<int>(t), s);
      if (n >= 0) layout.modules[at(index[t])].neighbour[at(s)] = index[at(n)];
    }
  }
  return layout;
}

}  // namespace

// Corners do not move, so values that depend on the surface alone are unchanged.
void Certifier::measure_on_surface(ModuleLayout& layout, Known& own, int threads) const {
  const auto corners_of = [](const PlacedModule& m) {
    Corners corners;
    for (std::size_t k = 0; k < 9; ++k) corners[k] = m.corner_mm[k / 3][static_cast<int>(k % 3)];
    return corners;
  };
  const auto found = [](const Known& known, const Corners& corners) {
    const auto place = known.find(corners);
    return place == known.end() ? nullptr : &place->second;
  };
  std::vector<PlacedModule*> unknown;
  for (PlacedModule& m : layout.modules) {
    const Corners corners = corners_of(m);
    const PlacedModule* measured = found(own, corners);
    if (measured == nullptr) measured = found(known_, corners);
    if (measured == nullptr) {
      unknown.push_back(&m);
      continue;
    }
    m.center_gap_mm = measured->center_gap_mm;
    m.edge_lift_mm = measured->edge_lift_mm;
    m.edge_depth_mm = measured->edge_depth_mm;
    m.overrun_mm = measured->overrun_mm;
    m.keep_out_mm = measured->keep_out_mm;
    m.bend_radius_mm = measured->bend_radius_mm;
  }
  in_parallel(threads, unknown.size(), [&](std::size_t k) {
    lattice::measure_on_surface(surface_, *unknown[k], layout.corner_cut_mm, options_.regions);
  });
  for (const PlacedModule* m : unknown) own.emplace(corners_of(*m), *m);
}

// The growth asks this of the mesh that it searches on. On the surface itself the nearest sheet may be another one: a
// rib or the other side of a thin wall that the decimated mesh lacks.
std::vector<int> Certifier::turned_modules(const ModuleLayout& layout) const {
  std::vector<int> turned;
  for (std::size_t k = options_.kept.size(); k < layout.modules.size(); ++k) {
    if (is_turned(surface_, layout.modules[k])) turned.push_back(static_cast<int>(k));
  }
  return turned;
}

ModuleLayout Certifier::certified(LatticeMesh net, Known& own, int threads) const {
  for (;;) {
    net.separate();
    std::vector<int> triangle_of;
    ModuleLayout layout = layout_of(net, triangle_of);
    copy_.carry_back(layout);
    restore_kept(options_.kept, layout);
    measure_on_surface(layout, own, threads);
    measure_between(layout);
    if (const std::vector<int> turned = turned_modules(layout); !turned.empty()) {
      for (const int k : turned) net.remove_triangle(triangle_of[at(k)]);
      continue;
    }
    const std::vector<WorstModule> worst = worst_modules(layout, limits_, options_.kept.size());
    if (worst.empty()) return layout;
    for (const WorstModule& w : worst) net.remove_triangle(triangle_of[at(w.module)]);
  }
}

}  // namespace triskin::lattice
