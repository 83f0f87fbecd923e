// SPDX-License-Identifier: GPL-3.0-or-later
#include "weight_regions.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "triskin/base/error.hpp"

namespace triskin::placement {
namespace {

constexpr double kMaxPoints = 1e6, kMaxWeight = 1e12;
// The raster extends this many steps beyond the regions; farther out the map continues its rim.
constexpr double kRim = 3.0;

bool contains(const std::vector<Vec2>& ring, const Vec2& p) {
  bool inside = false;
  for (std::size_t k = 0; k < ring.size(); ++k) {
    const Vec2 &a = ring[k], &b = ring[(k + 1) % ring.size()];
    if ((a.y() > p.y()) == (b.y() > p.y())) continue;
    if (p.x() < a.x() + (p.y() - a.y()) / (b.y() - a.y()) * (b.x() - a.x())) inside = !inside;
  }
  return inside;
}

void require_weight(const std::string& name, double weight) {
  if (!(weight >= 0.0 && weight <= kMaxWeight))
    throw InputError(fmt::format("weights: {} is {}; it must be in 0 … 1e12", name, weight));
}

void require_regions(const WeightRegions& w) {
  if (w.regions.empty()) throw InputError("weights: there are no regions");
  if (!(w.step_mm > 0.0 && std::isfinite(w.step_mm)))
    throw InputError(fmt::format("weights: step {} mm must be positive", w.step_mm));
  require_weight("elsewhere", w.elsewhere);
  require_weight("module_weight", w.module_weight);
  for (std::size_t k = 0; k < w.regions.size(); ++k) {
    require_weight(fmt::format("the weight of region {}", k), w.regions[k].weight);
    const auto& ring = w.regions[k].outline_mm;
    if (ring.size() < 3) throw InputError(fmt::format("weights: region {} needs at least three points", k));
    if (!std::ranges::all_of(ring, [](const Vec2& p) { return p.allFinite(); }))
      throw InputError(fmt::format("weights: region {}: a point is not finite", k));
  }
}

double worth_at(const WeightRegions& w, const Vec2& p) {
  double value = w.elsewhere;
  for (const auto& region : w.regions) {
    if (contains(region.outline_mm, p)) value = region.weight;
  }
  return std::max(0.0, value - w.module_weight);
}

}  // namespace

WeightMap weight_map_of(const WeightRegions& w) {
  require_regions(w);
  Vec2 low = Vec2::Constant(1e300), high = -low;
  for (const auto& region : w.regions) {
    for (const Vec2& p : region.outline_mm) {
      low = low.cwiseMin(p);
      high = high.cwiseMax(p);
    }
  }
  low -= Vec2::Constant(kRim * w.step_mm);
  high += Vec2::Constant(kRim * w.step_mm);
  const Vec2 count = ((high - low) / w.step_mm).array().ceil() + 1.0;
  if (!(count.prod() <= kMaxPoints))
    throw InputError(fmt::format("weights: a step of {} mm gives {:.2g} points, more than {:.0g}; take a longer step",
                                 w.step_mm, count.prod(), kMaxPoints));
  std::vector<std::vector<double>> values(static_cast<std::size_t>(count.y()));
  for (std::size_t r = 0; r < values.size(); ++r) {
    for (std::size_t c = 0; c < static_cast<std::size_t>(count.x()); ++c)
      values[r].push_back(worth_at(w, low + w.step_mm * Vec2(static_cast<double>(c), static_cast<double>(r))));
  }
  return {low, w.step_mm, values};
}

}  // namespace triskin::placement
