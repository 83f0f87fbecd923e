// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <filesystem>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "triskin/design/mesh.hpp"

namespace triskin::design {

/// Selects the part of the surface inside a ball, in the frame of the mesh, in mm.
struct Sphere {
  Vec3 center_mm = Vec3::Zero();
  double radius_mm = 0.0;  ///< The radius must be positive.
  bool operator==(const Sphere&) const = default;
};
/// Selects the part of the surface inside a box whose edges are parallel to the axes.
struct Box {
  Vec3 low_mm = Vec3::Zero(), high_mm = Vec3::Zero();  ///< The low corner is below the high one on every axis.
  bool operator==(const Box&) const = default;
};
/// Selects faces by their indices in Design::surface.
struct FaceSet {
  std::vector<int> faces;
};

/// A region states a requirement for a part of the surface (docs/regions.md).
struct Region {
  std::string name;  ///< Names are unique and not empty.
  std::variant<Sphere, Box, FaceSet> shape;
  /// A module whose centre lies in the region has this value, 0 … 1000; if unset, it has the value of elsewhere.
  std::optional<double> weight;
  /// True means that every place of the region must lie within `within_mm` of a module, seen along its normal.
  bool cover = false;
  bool free = false;       ///< True means that no module may lie over the region, so that its rim is a border.
  double within_mm = 2.0;  ///< Valid values are 0 to 30.
};

/// A cover can have several regions. If a module lies in several regions with a weight, the last one counts.
struct Regions {
  double elsewhere = 1.0;  ///< Modules outside all weighted regions have this value, 0 … 1000.
  std::vector<Region> list;
  [[nodiscard]] bool empty() const { return list.empty(); }
};

/// Some places of this must-cover region are not covered.
struct Uncovered {
  std::string region;
  double share = 0.0;            ///< The uncovered share of the area is in 0 … 1.
  Vec3 place_mm = Vec3::Zero();  ///< No place of the region is farther from the modules.
  /// The nearest module is this far from that place; infinity means that there is none nearby.
  double distance_mm = 0.0;
  std::string why;  ///< The text names the limit that refuses every module there (as Design: refused), or "room".
};

}  // namespace triskin::design
