// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <optional>
#include <string>

#include "triskin/lattice/grow_lattice.hpp"
#include "triskin/mesh/surface.hpp"

namespace triskin::geometry {

/// What keeps modules off a surface, at the place where it is least in the way.
struct Obstacle {
  std::string limit;              ///< "narrow", or the limit that refuses (names as in Design: refused)
  int places = 0, tried = 0;      ///< it refuses at so many of the places that were tried
  Vec3 place_mm{0, 0, 0};         ///< where `width_mm` or `radius_mm` was measured
  double width_mm = 0.0;          ///< "narrow": width of the surface where it is widest
  double radius_mm = 0.0;         ///< smaller radius of curvature there; 0: flat, or not what it is about
  double needed_radius_mm = 0.0;  ///< radius at which a surface of this shape would keep the limit; 0: as radius_mm
  double needed_limit_mm = 0.0;   ///< value of the limit that would allow a module there; 0: as radius_mm
};

/// Why no module lies on a surface: tries eight places, spread evenly, and says what refuses a module at most of them.
/// Empty: a module has room somewhere. Radius and limit are tied by the formulas of docs/bending.md. Cost: some 10 ms a
/// place. Errors: as why_uncovered().
[[nodiscard]] std::optional<Obstacle> what_refuses(const Surface& surface, const LayoutLimits& limits,
                                                   const SurfaceLatticeOptions& options = {});

}  // namespace triskin::geometry
