// SPDX-License-Identifier: GPL-3.0-or-later
#include <Eigen/Geometry>
#include <algorithm>
#include <map>
#include <string>

#include "index.hpp"
#include "triskin/geometry/map_modules.hpp"
#include "worst_places.hpp"

namespace triskin::geometry {
namespace {

constexpr double kSidesShare = 0.983;  // of lift and depth, which the checker walks alike: hardly a margin is left

class Keeper {
 public:
  Keeper(const Surface& surface, const LayoutLimits& limits, ModuleLayout& layout, const SurfaceRegions* regions)
      : surface_(surface), limits_(limits), layout_(layout), regions_(regions) {}

  void run() {
    for (PlacedModule& m : layout_.modules)
      measure_on_surface(surface_, m, layout_.corner_cut_mm, regions_);  // nothing moves from here on
    give_up_turned();
    give_up_bad();
    number_islands(layout_);
    for (const auto& [limit, count] : refused_) layout_.refused.emplace_back(limit, count);
  }

 private:
  void remove(const std::vector<bool>& bad) {
    std::vector<int> target(layout_.modules.size(), -1);
    std::vector<PlacedModule> kept;
    for (std::size_t k = 0; k < bad.size(); ++k) {
      if (bad[k]) continue;
      target[k] = static_cast<int>(kept.size());
      kept.push_back(layout_.modules[k]);
    }
    for (PlacedModule& m : kept) {
      for (int& n : m.neighbour) n = n < 0 ? -1 : target[at(n)];
    }
    layout_.modules = std::move(kept);
  }

  // How far over its limit, 1 = at the limit; the name of the limit that is broken most.
  [[nodiscard]] std::pair<double, const char*> worst(const PlacedModule& m) const {
    return std::max({std::pair{m.edge_error_mm / limits_.edge_error_mm, "edge_error_mm"},
                     std::pair{m.center_gap_mm / limits_.center_gap_mm, "center_gap_mm"},
                     std::pair{m.penetration_mm / limits_.penetration_mm, "penetration_mm"},
                     std::pair{m.overrun_mm / limits_.overrun_mm, "overrun_mm"},
                     std::pair{kSidesShare * m.edge_lift_mm / limits_.lift_mm, "lift_mm"},
                     std::pair{kSidesShare * m.edge_depth_mm / limits_.depth_mm, "depth_mm"},
                     std::pair{m.keep_out_mm / limits_.overrun_mm, "keep_out"}},
                    [](const auto& a, const auto& b) { return a.first < b.first; });
  }

  // Thin shells have two sheets: a module whose nearest sheet is the other one would be measured against that.
  void give_up_turned() {
    std::vector<bool> bad;
    for (const PlacedModule& m : layout_.modules) {
      const Vec3 middle = (m.corner_mm[0] + m.corner_mm[1] + m.corner_mm[2]) / 3.0;
      const Vec3 normal = (m.corner_mm[1] - m.corner_mm[0]).cross(m.corner_mm[2] - m.corner_mm[0]).normalized();
      bad.push_back(surface_.normal_at(surface_.closest(middle)).dot(normal) < 0.6);
    }
    if (const auto count = static_cast<int>(std::ranges::count(bad, true)); count > 0) refused_["outward"] += count;
    remove(bad);
  }

  // First joints (they become slits), then modules; a margin of 2 % keeps another measurement from disagreeing.
  void give_up_bad() {
    for (;;) {
      measure_between(layout_);
      if (open_bad_joints()) continue;
      std::vector<BrokenModule> broken;
      for (std::size_t k = 0; k < layout_.modules.size(); ++k) {
        const PlacedModule& m = layout_.modules[k];
        const double ratio = worst(m).first;
        if (ratio > 0.98)
          broken.push_back({static_cast<int>(k), ratio, (m.corner_mm[0] + m.corner_mm[1] + m.corner_mm[2]) / 3.0});
      }
      if (broken.empty()) return;
      std::vector<bool> bad(layout_.modules.size(), false);
      for (const int k : worst_of_their_places(broken)) {
        ++refused_[worst(layout_.modules[at(k)]).second];
        bad[at(k)] = true;
      }
      remove(bad);
    }
  }

  bool open_bad_joints() {
    bool any = false;
    for (PlacedModule& m : layout_.modules) {
      for (int s = 0; s < 3; ++s) {
        if (m.neighbour[at(s)] < 0) continue;
        if (m.hinge_gap_mm[at(s)] <= 0.98 * limits_.hinge_gap_mm && m.fold_rad[at(s)] <= 0.98 * limits_.fold_rad)
          continue;
        layout_.modules[at(m.neighbour[at(s)])].neighbour[at(across(m.tile, s).side)] = -1;
        m.neighbour[at(s)] = -1;
        any = true;
      }
    }
    return any;
  }

  const Surface& surface_;
  const LayoutLimits limits_;
  ModuleLayout& layout_;
  const SurfaceRegions* regions_;
  std::map<std::string, int> refused_;
};

}  // namespace

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

void keep_limits(const Surface& surface, const LayoutLimits& limits, ModuleLayout& layout,
                 const SurfaceRegions* regions) {
  Keeper(surface, limits, layout, regions).run();
}

}  // namespace triskin::geometry
