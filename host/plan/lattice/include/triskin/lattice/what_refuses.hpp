// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <optional>
#include <string>

#include "triskin/lattice/grow_lattice.hpp"
#include "triskin/mesh/surface.hpp"

namespace triskin::lattice {

/// Tells what keeps modules off a surface, at the place where it obstructs least.
struct Obstacle {
  std::string limit;          ///< "narrow", or the name of the limit that refuses (names as in Design: refused).
  int places = 0, tried = 0;  ///< The limit refuses at `places` of the `tried` places.
  Vec3 place_mm{0, 0, 0};     ///< `width_mm` or `radius_mm` was measured here.
  double width_mm = 0.0;      ///< For "narrow", the width of the surface at its widest place.
  /// The smaller radius of curvature there; 0 if the surface is flat or the limit does not depend on it.
  double radius_mm = 0.0;
  /// A surface of this shape would keep the limit with this radius; 0 as for radius_mm.
  double needed_radius_mm = 0.0;
  double needed_limit_mm = 0.0;  ///< This value of the limit would allow a module there; 0 as for radius_mm.
};

/// Explains why no module lies on a surface: tries eight places, spread evenly, and returns the limit that refuses a
/// module at most of them. Empty means that a module has room somewhere. Radius and limit are tied by the formulas of
/// docs/limits.md. Cost: some 10 ms per place. Errors: as why_uncovered().
[[nodiscard]] std::optional<Obstacle> what_refuses(const mesh::Surface& surface, const LayoutLimits& limits,
                                                   const SurfaceLatticeOptions& options = {});

}  // namespace triskin::lattice
