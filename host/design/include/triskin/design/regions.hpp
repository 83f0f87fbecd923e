// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <filesystem>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "triskin/design/mesh.hpp"

namespace triskin::design {

/// Part of a cover, in the frame of its mesh, mm: what of the surface lies in a ball,
struct Sphere {
  Vec3 center_mm = Vec3::Zero();
  double radius_mm = 0.0;  ///< > 0
  bool operator==(const Sphere&) const = default;
};
/// in a box along the axes,
struct Box {
  Vec3 low_mm = Vec3::Zero(), high_mm = Vec3::Zero();  ///< low < high on every axis
  bool operator==(const Box&) const = default;
};
/// or on faces of it: indices of Design::surface.
struct FaceSet {
  std::vector<int> faces;
};

/// Requirement for a part of the surface (docs/regions.md).
struct Region {
  std::string name;  ///< unique, not empty
  std::variant<Sphere, Box, FaceSet> shape;
  std::optional<double>
      weight;              ///< 0 … 1000 modules that a module is worth whose centre lies in it; none: as elsewhere
  bool cover = false;      ///< every place of it must lie within `within_mm` of a module, seen along its normal
  bool free = false;       ///< no module may lie over it: its rim is a border
  double within_mm = 2.0;  ///< 0 … 30
};

/// Regions of a cover. Of several with a weight the last one counts.
struct Regions {
  double elsewhere = 1.0;  ///< 0 … 1000: worth of a module in no region with a weight
  std::vector<Region> list;
  [[nodiscard]] bool empty() const { return list.empty(); }
};

/// A must-cover region that is not covered everywhere.
struct Uncovered {
  std::string region;
  double share = 0.0;            ///< uncovered share of its area, 0 … 1
  Vec3 place_mm = Vec3::Zero();  ///< the place farthest from the modules
  double distance_mm = 0.0;      ///< distance of that place from the nearest module; infinity: none near
  std::string why;               ///< limit that refuses every module there (as Design: refused), or "room"
};

}  // namespace triskin::design
