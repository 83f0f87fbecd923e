// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <algorithm>
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
/// Selects faces of the surface by their indices in Design::surface.
struct FaceSet {
  std::vector<FaceIndex> faces;
};
/// Selects the places near another body: their normal passes within `margin_mm` of it between `below_mm` under the
/// surface and `above_mm` over it. A closed mesh counts as solid; an open mesh is a sheet without an inside.
struct Obstacle {
  Mesh mesh;               ///< The mesh is in mm, in the frame of the part, and faces outward if it is closed.
  double margin_mm = 0.0;  ///< The margin ranges from 0 to 1000.
  double above_mm = 0.0;   ///< The height ranges from 0 to 200.
  double below_mm = 0.0;   ///< The depth ranges from 0 to 200.
};
/// Selects a strip along borders of the surface: every place within `margin_mm`, straight through space, of a border
/// whose width lies between the two limits. The width is the largest distance between two of its corners.
struct BorderStrip {
  static constexpr double kMaxWidth_mm = 1e5;  ///< This exceeds the width of every part.
  double margin_mm = 0.0;                      ///< The margin must be positive.
  double min_width_mm = 0.0;                   ///< Narrower borders, such as those of holes, get no strip.
  double max_width_mm = kMaxWidth_mm;          ///< Wider borders, such as the outline, get no strip.
};

/// A region states a requirement for a part of the surface (docs/regions.md).
struct Region {
  std::string name;  ///< It is unique and not empty.
  std::variant<Sphere, Box, FaceSet, Obstacle, BorderStrip> shape;
  /// A module whose centre lies in the region is worth 0 … 1000; without a value the value of elsewhere holds.
  std::optional<double> weight;
  bool cover = false;      ///< Every place of it must lie within `within_mm` of a module, seen along its normal.
  bool free = false;       ///< No module may lie over it, so its rim is a border.
  bool entry = false;      ///< Once a region sets this, controller cables may enter only in regions that do.
  double within_mm = 2.0;  ///< It ranges from 0 to 30.
};

/// A cover can have several regions. If a module lies in several regions with a weight, the last one counts.
struct Regions {
  double elsewhere = 1.0;  ///< Modules outside all weighted regions have this value, 0 … 1000.
  std::vector<Region> list;
  [[nodiscard]] bool empty() const { return list.empty(); }
  /// Returns true if cables may enter only in some places.
  [[nodiscard]] bool limits_entries() const { return std::ranges::any_of(list, &Region::entry); }
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
