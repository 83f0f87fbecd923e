// SPDX-License-Identifier: GPL-3.0-or-later
#include "worst_places.hpp"

#include <algorithm>

#include "index.hpp"

namespace triskin::geometry {
namespace {

constexpr double kFinalMargin = 0.98;
constexpr double kSidesShare = 0.983;  // of lift and depth, which the checker walks alike: hardly a margin is left
constexpr double kApart_mm = 60.0;     // of centres: modules that have no side, corner or overlap in common

struct BrokenModule {
  int module;
  double ratio;
  Vec3 center_mm;
};

double worst_ratio(const PlacedModule& m, const LayoutLimits& l) {
  double worst = worst_limit(m, l).first;
  for (std::size_t s = 0; s < 3; ++s)
    worst = std::max({worst, m.hinge_gap_mm[s] / l.hinge_gap_mm, m.fold_rad[s] / l.fold_rad});
  return worst;
}

}  // namespace

std::pair<double, const char*> worst_limit(const PlacedModule& m, const LayoutLimits& l) {
  return std::max({std::pair{m.edge_error_mm / l.edge_error_mm, "edge_error_mm"},
                   std::pair{m.center_gap_mm / l.center_gap_mm, "center_gap_mm"},
                   std::pair{m.penetration_mm / l.penetration_mm, "penetration_mm"},
                   std::pair{m.overrun_mm / l.overrun_mm, "overrun_mm"},
                   std::pair{kSidesShare * m.edge_lift_mm / l.lift_mm, "lift_mm"},
                   std::pair{kSidesShare * m.edge_depth_mm / l.depth_mm, "depth_mm"},
                   std::pair{m.keep_out_mm / l.overrun_mm, "keep_out"}},
                  [](const auto& a, const auto& b) { return a.first < b.first; });
}

std::vector<int> worst_modules(const ModuleLayout& layout, const LayoutLimits& limits, std::size_t kept) {
  std::vector<BrokenModule> broken;
  for (std::size_t k = kept; k < layout.modules.size(); ++k) {
    const PlacedModule& m = layout.modules[k];
    const double ratio = worst_ratio(m, limits);
    if (ratio > kFinalMargin)
      broken.push_back({static_cast<int>(k), ratio, (m.corner_mm[0] + m.corner_mm[1] + m.corner_mm[2]) / 3.0});
  }
  std::vector<int> worst;
  for (const BrokenModule& b : broken) {
    if (std::ranges::none_of(broken, [&](const BrokenModule& o) {
          return std::pair(-o.ratio, o.module) < std::pair(-b.ratio, b.module) &&
                 (o.center_mm - b.center_mm).norm() < kApart_mm;
        }))
      worst.push_back(b.module);
  }
  return worst;
}

}  // namespace triskin::geometry
