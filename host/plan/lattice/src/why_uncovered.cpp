// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "grower.hpp"
#include "triskin/base/index.hpp"
#include "triskin/lattice/grow_lattice.hpp"
#include "triskin/mesh/surface_regions.hpp"

namespace triskin::lattice {
namespace {

constexpr int kTurns = 24;  // A module is its own image after 120°, so we try 24 turns within that angle.
constexpr std::array kOffsets_mm{0.0, 5.0, 9.0, 13.0};
constexpr int kWays = 12;

}  // namespace

std::string why_uncovered(const mesh::Surface& surface, const LayoutLimits& limits,
                          const SurfaceLatticeOptions& options, const Vec3& place_mm, double within_mm) {
  const std::vector<Vec3> none;
  const Rules rules(surface, limits, options.regions == nullptr ? none : options.regions->free_points());
  const std::vector<Sample> no_samples;
  Grower grower(surface, rules, no_samples, corner_lift_of(limits, options), Grower::Clock::time_point::max());
  const Vec3 n = surface.normal_at(surface.closest(place_mm)), x = n.unitOrthogonal(), y = n.cross(x);
  const auto around = [&](double angle, double r) { return Vec3(r * (std::cos(angle) * x + std::sin(angle) * y)); };
  for (const double offset : kOffsets_mm) {
    for (int d = 0; d < (offset > 0.0 ? kWays : 1); ++d) {
      const Vec3 center = place_mm + around(2.0 * M_PI * d / kWays, offset);
      for (int turn = 0; turn < kTurns; ++turn) {
        Triangle corners;
        for (int k = 0; k < 3; ++k)
          corners[at(k)] =
              center + around(2.0 * M_PI * (k + turn / static_cast<double>(kTurns)) / 3.0, 2.0 * kHeight_mm / 3.0);
        LatticeMesh net(surface.mesh().vertices, options.corner_cut_mm);
        if (!grower.try_seed(net, corners)) continue;
        if (mesh::distance_beside(net.triangles()[0].rigid, options.corner_cut_mm, place_mm) <= within_mm)
          return "room";
        ++grower.refused[static_cast<std::size_t>(Refusal::kOverrun)];  // The border pushed the module away.
      }
    }
  }
  const auto most = std::ranges::max_element(grower.refused) - grower.refused.begin();
  return name_of(static_cast<Refusal>(most));
}

}  // namespace triskin::lattice
