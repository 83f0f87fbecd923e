// SPDX-License-Identifier: GPL-3.0-or-later
#include "triskin/design/cover_part.hpp"

#include <algorithm>
#include <nlohmann/json.hpp>

#include "triskin/design/json_fields.hpp"
#include "triskin/design/module_number.hpp"

namespace triskin::design {
namespace {

constexpr std::array kPartKeys{"sphere", "box", "island", "modules"};

Sphere read_sphere(const JsonValue& v) {
  only_keys(v, {"center_mm", "radius_mm"}, "docs/design_file.md");
  Sphere s{vec3(v["center_mm"]), number_in(v["radius_mm"], 0.0, kMaxLength_mm)};
  if (!(s.radius_mm > 0.0)) v["radius_mm"].fail("must be positive");
  return s;
}

Box read_box(const JsonValue& v) {
  only_keys(v, {"low_mm", "high_mm"}, "docs/design_file.md");
  Box b{vec3(v["low_mm"]), vec3(v["high_mm"])};
  if (!(b.low_mm.array() < b.high_mm.array()).all()) v["high_mm"].fail("must be above \"low_mm\" along every axis");
  return b;
}

ModulePart read_modules(const JsonValue& v) {
  ModulePart r;
  for (std::size_t k = 0; k < v.size(); ++k) r.modules.push_back(v.at(k).integer(0, kMaxCount));
  return r;
}

nlohmann::json point_json(const Vec3& p) {
  return {p.x(), p.y(), p.z()};
}

// std::visit needs one function for each kind of part.
struct HoldsPoint {
  const Vec3& point;
  bool operator()(const Sphere& s) const { return (point - s.center_mm).norm() <= s.radius_mm; }
  bool operator()(const Box& b) const {
    return (point.array() >= b.low_mm.array()).all() && (point.array() <= b.high_mm.array()).all();
  }
  bool operator()(const IslandPart&) const { return false; }
  bool operator()(const ModulePart&) const { return false; }
};

struct AsJson {
  nlohmann::json operator()(const Sphere& s) const {
    return {{"sphere", {{"center_mm", point_json(s.center_mm)}, {"radius_mm", s.radius_mm}}}};
  }
  nlohmann::json operator()(const Box& b) const {
    return {{"box", {{"low_mm", point_json(b.low_mm)}, {"high_mm", point_json(b.high_mm)}}}};
  }
  nlohmann::json operator()(const IslandPart& r) const { return {{"island", r.island}}; }
  nlohmann::json operator()(const ModulePart& r) const { return {{"modules", r.modules}}; }
};

}  // namespace

bool holds(const CoverPart& part, const Vec3& point_mm) {
  return std::visit(HoldsPoint{point_mm}, part);
}

bool holds(const CoverPart& part, const ModuleLayout& layout, int id) {
  const PlacedModule& m = layout.modules.at(static_cast<std::size_t>(id));
  if (const auto* island = std::get_if<IslandPart>(&part)) return m.island == island->island;
  if (const auto* list = std::get_if<ModulePart>(&part))
    return std::ranges::find(list->modules, number_of(layout, id).value) != list->modules.end();
  return holds(part, (m.corner_mm[0] + m.corner_mm[1] + m.corner_mm[2]) / 3.0);
}

CoverPart read_cover_part(const JsonValue& v) {
  const auto count = std::ranges::count_if(kPartKeys, [&](const char* key) { return has(v, key); });
  if (count != 1) v.fail("must have one of the keys \"sphere\", \"box\", \"island\", \"modules\"");
  if (has(v, "sphere")) return read_sphere(v["sphere"]);
  if (has(v, "box")) return read_box(v["box"]);
  if (has(v, "island")) return IslandPart{v["island"].integer(0, kMaxCount)};
  return read_modules(v["modules"]);
}

nlohmann::json cover_part_json(const CoverPart& part) {
  return std::visit(AsJson{}, part);
}

}  // namespace triskin::design
