// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <nlohmann/json_fwd.hpp>
#include <variant>
#include <vector>

#include "triskin/design/mesh.hpp"
#include "triskin/design/module.hpp"

namespace triskin::design {

class JsonValue;

/// All points at most `radius_mm` > 0 from `center_mm`, mesh frame.
struct Sphere {
  Vec3 center_mm = Vec3::Zero();
  double radius_mm = 0.0;
  bool operator==(const Sphere&) const = default;
};
/// All points from `low_mm` to `high_mm` along every axis of the mesh frame, ends included.
struct Box {
  Vec3 low_mm = Vec3::Zero(), high_mm = Vec3::Zero();
  bool operator==(const Box&) const = default;
};
/// All modules of an island.
struct IslandRegion {
  int island = 0;
  bool operator==(const IslandRegion&) const = default;
};
/// Modules by id, in any order.
struct ModuleRegion {
  std::vector<int> modules;
  bool operator==(const ModuleRegion&) const = default;
};
/// A part of a cover that a person names. The first two are parts of space and hold points; the last two name modules
/// of one layout and hold no point.
using Region = std::variant<Sphere, Box, IslandRegion, ModuleRegion>;

/// Whether a region is a part of space.
[[nodiscard]] inline bool is_place(const Region& region) {
  return std::holds_alternative<Sphere>(region) || std::holds_alternative<Box>(region);
}
/// Whether a point (mesh frame, mm) lies in a region; never in an island or a list of modules. Constant cost.
[[nodiscard]] bool holds(const Region& region, const Vec3& point_mm);
/// Whether module `id` of a layout belongs to a region: of a part of space, when its centre lies in it. Errors:
/// std::out_of_range for an id that the layout lacks. Cost: linear in a list of modules, else constant.
[[nodiscard]] bool holds(const Region& region, const ModuleLayout& layout, int id);

/// Reads one of {"sphere": {"center": [x, y, z], "radius_mm": r}}, {"box": {"low": [x, y, z], "high": [x, y, z]}},
/// {"island": k}, {"modules": [id, …]}; `v` may have other keys beside. Errors: InputError with file and place for none
/// or several of these keys, wrong types, a radius that is not positive, a box without inside, and negative numbers of
/// modules. Cost: linear.
[[nodiscard]] Region read_region(const JsonValue& v);
/// The object that read_region() reads. Cost: linear.
[[nodiscard]] nlohmann::json region_json(const Region& region);

}  // namespace triskin::design
