// SPDX-License-Identifier: GPL-3.0-or-later
#include "keep_limits.hpp"

#include <tbb/parallel_for.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <map>
#include <string>

#include "fold_limit.hpp"
#include "overlapping_pairs.hpp"
#include "triskin/base/index.hpp"
#include "triskin/lattice/map_modules.hpp"
#include "worst_places.hpp"

namespace triskin::lattice {
namespace {

// `check` asks for 0.5; the difference leaves room for another way of measuring.
constexpr double kOutwardCosine = 0.6;

class Keeper {
 public:
  Keeper(const mesh::Surface& surface, const LayoutLimits& limits, ModuleLayout& layout)
      : surface_(surface), limits_(limits), layout_(layout) {}

  void run() {
    give_up_turned();
    give_up_bad();
    number_islands(layout_);
    for (const auto& [limit, count] : refused_) {
      const auto known = std::ranges::find(layout_.refused, limit, [](const auto& entry) { return entry.first; });
      if (known == layout_.refused.end())
        layout_.refused.emplace_back(limit, count);
      else
        known->second += count;
    }
  }

 private:
  void give_up_turned() {
    std::vector<bool> bad;
    for (const PlacedModule& m : layout_.modules) bad.push_back(is_turned(surface_, m));
    if (const auto count = static_cast<int>(std::ranges::count(bad, true)); count > 0) refused_["outward"] += count;
    remove_modules(layout_, bad);
  }

  // Drops joints first (they become slits), then modules; a margin of 2 % keeps another measurement from disagreeing.
  void give_up_bad() {
    // Pairs are measured once: nothing moves below, so they can only disappear.
    std::vector<OverlappingPair> pairs = overlapping_pairs(layout_);
    for (;;) {
      measure_between(layout_, pairs);
      if (open_bad_joints()) continue;
      const std::vector<WorstModule> worst = worst_modules(layout_, limits_);
      if (worst.empty()) return;
      std::vector<bool> bad(layout_.modules.size(), false);
      for (const WorstModule& w : worst) {
        ++refused_[w.limit];
        bad[at(w.module)] = true;
      }
      const std::vector<int> new_id = remove_modules(layout_, bad);
      std::erase_if(pairs, [&](const OverlappingPair& p) { return new_id[at(p.a)] < 0 || new_id[at(p.b)] < 0; });
      for (OverlappingPair& p : pairs) p = {new_id[at(p.a)], new_id[at(p.b)], p.depth_mm};
    }
  }

  bool open_bad_joints() {
    bool any = false;
    for (PlacedModule& m : layout_.modules) {
      for (int s = 0; s < 3; ++s) {
        if (m.neighbour[at(s)] < 0) continue;
        if (m.hinge_gap_mm[at(s)] <= 0.98 * limits_.hinge_gap_mm &&
            m.fold_rad[at(s)] <= 0.98 * fold_limit_of(limits_, layout_.modules, m, s))
          continue;
        layout_.modules[at(m.neighbour[at(s)])].neighbour[at(across(m.tile, s).side)] = -1;
        m.neighbour[at(s)] = -1;
        any = true;
      }
    }
    return any;
  }

  const mesh::Surface& surface_;
  const LayoutLimits limits_;
  ModuleLayout& layout_;
  std::map<std::string, int> refused_;
};

}  // namespace

bool is_turned(const mesh::Surface& surface, const PlacedModule& m) {
  const Vec3 middle = (m.corner_mm[0] + m.corner_mm[1] + m.corner_mm[2]) / 3.0;
  const Vec3 normal = (m.corner_mm[1] - m.corner_mm[0]).cross(m.corner_mm[2] - m.corner_mm[0]).normalized();
  return surface.normal_at(surface.closest(middle)).dot(normal) < kOutwardCosine;
}

std::vector<int> remove_modules(ModuleLayout& layout, const std::vector<bool>& gone) {
  std::vector<int> new_id(layout.modules.size(), -1);
  std::vector<PlacedModule> kept;
  std::vector<int> numbers;
  for (std::size_t k = 0; k < gone.size(); ++k) {
    if (gone[k]) continue;
    new_id[k] = static_cast<int>(kept.size());
    kept.push_back(layout.modules[k]);
    if (!layout.numbers.empty()) numbers.push_back(layout.numbers[k]);
  }
  layout.numbers = std::move(numbers);
  for (PlacedModule& m : kept) {
    for (int& n : m.neighbour) n = n < 0 ? -1 : new_id[at(n)];
  }
  layout.modules = std::move(kept);
  return new_id;
}

void number_islands(ModuleLayout& layout) {
  std::vector<PlacedModule>& modules = layout.modules;
  for (PlacedModule& m : modules) m.island = -1;
  layout.islands = 0;
  for (std::size_t first = 0; first < modules.size(); ++first) {
    if (modules[first].island >= 0) continue;
    std::vector<int> queue{static_cast<int>(first)};
    modules[first].island = layout.islands;
    for (std::size_t q = 0; q < queue.size(); ++q) {
      for (const int n : modules[at(queue[q])].neighbour) {
        if (n < 0 || modules[at(n)].island >= 0) continue;
        modules[at(n)].island = layout.islands;
        queue.push_back(n);
      }
    }
    ++layout.islands;
  }
}

void keep_limits(const mesh::Surface& surface, const LayoutLimits& limits, ModuleLayout& layout,
                 const mesh::SurfaceRegions* regions) {
  measure_modules(surface, layout, 0, regions);
  keep_limits_as_measured(surface, limits, layout);
}

void measure_modules(const mesh::Surface& surface, ModuleLayout& layout, std::size_t first,
                     const mesh::SurfaceRegions* regions) {
  tbb::parallel_for(first, layout.modules.size(), [&](std::size_t k) {
    measure_on_surface(surface, layout.modules[k], layout.corner_cut_mm, regions);
  });
}

void keep_limits_as_measured(const mesh::Surface& surface, const LayoutLimits& limits, ModuleLayout& layout) {
  Keeper(surface, limits, layout).run();
}

}  // namespace triskin::lattice
