// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <nlohmann/json_fwd.hpp>
#include <variant>
#include <vector>

#include "triskin/design/mesh.hpp"
#include "triskin/design/module.hpp"
#include "triskin/design/regions.hpp"

namespace triskin::design {

class JsonValue;

/// Selects all modules of an island.
struct IslandPart {
  int island = 0;
  bool operator==(const IslandPart&) const = default;
};
/// Selects modules by their numbers (module_number.hpp), in any order.
struct ModulePart {
  std::vector<int> modules;
  bool operator==(const ModulePart&) const = default;
};
/// A person names a part of a cover in one of these ways. Spheres and boxes are parts of space and contain points;
/// islands and lists of modules belong to one layout and contain no point.
using CoverPart = std::variant<Sphere, Box, IslandPart, ModulePart>;

/// Returns true if a part is a part of space.
[[nodiscard]] inline bool is_place(const CoverPart& part) {
  return std::holds_alternative<Sphere>(part) || std::holds_alternative<Box>(part);
}
/// Returns true if a point (mesh frame, mm) lies in a part; always false for an island or a list of modules. Constant
/// cost.
[[nodiscard]] bool holds(const CoverPart& part, const Vec3& point_mm);
/// Returns true if module `id` of a layout belongs to a part; in a part of space, its centre decides. Errors:
/// std::out_of_range for an id that the layout lacks. Cost: linear in a list of modules, else constant.
[[nodiscard]] bool holds(const CoverPart& part, const ModuleLayout& layout, int id);

/// Reads a part: {"sphere": {"center_mm": [x, y, z], "radius_mm": r}}, {"box": {"low_mm": [x, y, z], "high_mm": [x, y,
/// z]}}, {"island": k}, {"modules": [number, …]}; `v` may have other keys beside. Errors: InputError with file, place
/// for none or several of these keys, wrong types, a radius that is not positive, a box without inside, and negative
/// numbers of modules. Cost: linear.
[[nodiscard]] CoverPart read_cover_part(const JsonValue& v);
/// Writes the object that read_cover_part() reads. Cost: linear.
[[nodiscard]] nlohmann::json cover_part_json(const CoverPart& part);

}  // namespace triskin::design
