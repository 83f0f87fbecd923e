// SPDX-License-Identifier: GPL-3.0-or-later
#include "worst_places.hpp"

#include <algorithm>
#include <utility>

#include "fold_limit.hpp"
#include "overlap.hpp"
#include "point_grid.hpp"
#include "triskin/base/index.hpp"

namespace triskin::lattice {
namespace {

constexpr double kFinalMargin = 0.98;
// Lift and depth need hardly any margin because the checker walks the sides in the same way.
constexpr double kSidesShare = 0.983;
constexpr double kApart_mm = 60.0;  // Modules with centres this far apart have no side, corner or overlap in common.
constexpr double kNear_mm = 40.0;   // Modules that touch have centres at most two circumradii apart, which is 34.6 mm.
constexpr const char* kPierced = "pierced";

struct BrokenModule {
  WorstModule module;
  double ratio;
  Vec3 center_mm;
};

Vec3 center_of(const PlacedModule& m) {
  return (m.corner_mm[0] + m.corner_mm[1] + m.corner_mm[2]) / 3.0;
}

// Returns how far a module is over its limits (1 means at the limit), and the limit that is broken most.
std::pair<double, const char*> worst_limit(const ModuleLayout& layout, const PlacedModule& m, const LayoutLimits& l) {
  double fold = 0.0;
  for (int s = 0; s < 3; ++s) {
    if (m.neighbour[at(s)] >= 0) fold = std::max(fold, m.fold_rad[at(s)] / fold_limit_of(l, layout.modules, m, s));
  }
  return std::max(
      {std::pair{m.edge_error_mm / l.edge_error_mm, "edge_error_mm"},
       std::pair{m.center_gap_mm / l.center_gap_mm, "center_gap_mm"},
       std::pair{m.penetration_mm / l.penetration_mm, "penetration_mm"},
       std::pair{m.overrun_mm / l.overrun_mm, "overrun_mm"},
       std::pair{kSidesShare * m.edge_lift_mm / l.lift_mm, "lift_mm"},
       std::pair{kSidesShare * m.edge_depth_mm / l.depth_mm, "depth_mm"},
       std::pair{m.keep_out_mm / l.overrun_mm, "keep_out"},
       std::pair{std::ranges::max(m.hinge_gap_mm) / l.hinge_gap_mm, "hinge_gap_mm"}, std::pair{fold, "fold_rad"}},
      [](const auto& a, const auto& b) { return a.first < b.first; });
}

std::vector<WorstModule> broken_most(const ModuleLayout& layout, const LayoutLimits& limits, std::size_t kept) {
  std::vector<BrokenModule> broken;
  for (std::size_t k = kept; k < layout.modules.size(); ++k) {
    const PlacedModule& m = layout.modules[k];
    const auto [ratio, limit] = worst_limit(layout, m, limits);
    if (ratio > kFinalMargin) broken.push_back({{static_cast<int>(k), limit}, ratio, center_of(m)});
  }
  std::vector<WorstModule> worst;
  for (const BrokenModule& b : broken) {
    if (std::ranges::none_of(broken, [&](const BrokenModule& o) {
          return std::pair(-o.ratio, o.module.module) < std::pair(-b.ratio, b.module.module) &&
                 (o.center_mm - b.center_mm).norm() < kApart_mm;
        }))
      worst.push_back(b.module);
  }
  return worst;
}

// If the other module of a pair is removed anyway, no further one is.
std::vector<WorstModule> piercing(const ModuleLayout& layout, double allowed_mm, std::size_t kept) {
  std::vector<Vec3> centers;
  for (const PlacedModule& m : layout.modules) centers.push_back(center_of(m));
  lattice::PointGrid grid(centers, kNear_mm);
  std::vector<WorstModule> found;
  for (std::size_t b = 0; b < centers.size(); ++b) {
    const auto meets = [&](int a) {
      return lattice::pierced(layout.modules[at(a)].corner_mm, layout.modules[b].corner_mm, layout.corner_cut_mm,
                              allowed_mm);
    };
    if (b >= kept && grid.any_near(centers[b], kNear_mm, meets))
      found.push_back({static_cast<int>(b), kPierced});
    else
      grid.add(static_cast<int>(b), centers[b]);
  }
  return found;
}

}  // namespace

std::vector<WorstModule> worst_modules(const ModuleLayout& layout, const LayoutLimits& limits, std::size_t kept) {
  std::vector<WorstModule> worst = broken_most(layout, limits, kept);
  return worst.empty() ? piercing(layout, kFinalMargin * limits.penetration_mm, kept) : worst;
}

}  // namespace triskin::lattice
