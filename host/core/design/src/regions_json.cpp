// SPDX-License-Identifier: GPL-3.0-or-later
#include "regions_json.hpp"

#include <nlohmann/json.hpp>

#include "mesh_json.hpp"
#include "triskin/base/files.hpp"
#include "triskin/base/text_file.hpp"
#include "triskin/design/design_text.hpp"
#include "triskin/design/file_head.hpp"
#include "triskin/design/json_fields.hpp"
#include "triskin/design/region_file.hpp"

namespace triskin::design {
namespace {

using nlohmann::json;

constexpr const char* kRegionsPage = "docs/regions.md";
constexpr double kMaxWeight = 1e6, kMaxWorth = kMaxWeight * kMaxCount;

json point(const Vec3& p) {
  return json::array({p.x(), p.y(), p.z()});
}

void add_shape(const Region& r, json& j) {
  if (const auto* s = std::get_if<Sphere>(&r.shape))
    j["sphere"] = {{"center_mm", point(s->center_mm)}, {"radius_mm", s->radius_mm}};
  else if (const auto* b = std::get_if<Box>(&r.shape))
    j["box"] = {{"low_mm", point(b->low_mm)}, {"high_mm", point(b->high_mm)}};
  else if (const auto* o = std::get_if<Obstacle>(&r.shape))
    j["obstacle"] = {{"margin_mm", o->margin_mm},
                     {"above_mm", o->above_mm},
                     {"below_mm", o->below_mm},
                     {"mesh", mesh_json(o->mesh)}};
  else if (const auto* strip = std::get_if<BorderStrip>(&r.shape))
    j["border"] = {
        {"margin_mm", strip->margin_mm}, {"min_width_mm", strip->min_width_mm}, {"max_width_mm", strip->max_width_mm}};
  else
    j["faces"] = std::get<FaceSet>(r.shape).faces;
}

json region_json(const Region& r) {
  json j = {{"name", r.name}};
  add_shape(r, j);
  if (r.weight) j["weight"] = *r.weight;
  if (r.free) j["free"] = true;
  if (r.entry) j["entry"] = true;
  if (r.cover) {
    j["cover"] = true;
    j["within_mm"] = r.within_mm;
  }
  return j;
}

double length_or(const JsonValue& v, const char* key, double otherwise) {
  return has(v, key) ? number_in(v[key], 0.0, kMaxLength_mm) : otherwise;
}

// A design contains the mesh of an obstacle; a region file only names the file of that mesh.
Obstacle read_obstacle(const JsonValue& v, WantedRegion& wanted) {
  only_keys(v, {"file", "object", "mesh", "margin_mm", "above_mm", "below_mm"}, kRegionsPage);
  Obstacle o;
  o.margin_mm = length_or(v, "margin_mm", 0.0);
  o.above_mm = length_or(v, "above_mm", 0.0);
  o.below_mm = length_or(v, "below_mm", 0.0);
  if (has(v, "mesh")) o.mesh = read_mesh_json(v["mesh"]);
  if (has(v, "file")) wanted.file = v["file"].text();
  if (has(v, "object")) wanted.object = v["object"].text();
  if (!has(v, "mesh") && !has(v, "file") && !has(v, "object")) v.fail("needs a \"file\", an \"object\" or both");
  return o;
}

BorderStrip read_border_strip(const JsonValue& v) {
  only_keys(v, {"margin_mm", "min_width_mm", "max_width_mm"}, kRegionsPage);
  return {number_in(v["margin_mm"], 0.0, kMaxLength_mm), length_or(v, "min_width_mm", 0.0),
          length_or(v, "max_width_mm", BorderStrip::kMaxWidth_mm)};
}

void require_one_shape(const JsonValue& v) {
  int shapes = 0;
  for (const char* shape : {"sphere", "box", "faces", "group", "obstacle", "border"}) shapes += has(v, shape) ? 1 : 0;
  if (shapes != 1) v.fail("needs one of \"sphere\", \"box\", \"faces\", \"group\", \"obstacle\" and \"border\"");
}

FaceSet read_face_set(const JsonValue& v) {
  FaceSet set;
  for (std::size_t k = 0; k < v.size(); ++k) set.faces.emplace_back(v.at(k).integer(0, 2'000'000'000));
  return set;
}

void read_shape(const JsonValue& v, WantedRegion& wanted) {
  Region& r = wanted.region;
  require_one_shape(v);
  if (has(v, "obstacle")) {
    r.shape = read_obstacle(v["obstacle"], wanted);
  } else if (has(v, "border")) {
    r.shape = read_border_strip(v["border"]);
  } else if (has(v, "sphere")) {
    only_keys(v["sphere"], {"center_mm", "radius_mm"}, kRegionsPage);
    r.shape = Sphere{vec3(v["sphere"]["center_mm"]), number_in(v["sphere"]["radius_mm"], 0.0, kMaxLength_mm)};
  } else if (has(v, "box")) {
    only_keys(v["box"], {"low_mm", "high_mm"}, kRegionsPage);
    r.shape = Box{vec3(v["box"]["low_mm"]), vec3(v["box"]["high_mm"])};
  } else if (has(v, "faces")) {
    r.shape = read_face_set(v["faces"]);
  } else {
    wanted.group = v["group"].text();
    r.shape = FaceSet{};
  }
}

WantedRegion read_region(const JsonValue& v) {
  only_keys(v,
            {"name", "sphere", "box", "faces", "group", "obstacle", "border", "weight", "cover", "free", "entry",
             "within_mm"},
            kRegionsPage);
  WantedRegion wanted;
  Region& r = wanted.region;
  r.name = v["name"].text();
  read_shape(v, wanted);
  if (has(v, "entry")) r.entry = v["entry"].boolean();
  if (has(v, "weight")) r.weight = number_in(v["weight"], -kMaxWeight, kMaxWeight);
  if (has(v, "cover")) r.cover = v["cover"].boolean();
  if (has(v, "free")) r.free = v["free"].boolean();
  if (has(v, "within_mm")) r.within_mm = number_in(v["within_mm"], 0.0, kMaxLength_mm);
  return wanted;
}

std::vector<WantedRegion> read_list(const JsonValue& v) {
  std::vector<WantedRegion> list;
  for (std::size_t k = 0; k < v.size(); ++k) list.push_back(read_region(v.at(k)));
  return list;
}

json uncovered_json(const Uncovered& u) {
  json j = {{"region", u.region}, {"share", u.share}, {"place_mm", point(u.place_mm)}, {"why", u.why}};
  if (std::isfinite(u.distance_mm)) j["distance_mm"] = u.distance_mm;
  return j;
}

Uncovered read_uncovered(const JsonValue& v) {
  only_keys(v, {"region", "share", "place_mm", "distance_mm", "why"}, kRegionsPage);
  return {v["region"].text(), number_in(v["share"], 0.0, 1.0 + 1e-9), vec3(v["place_mm"]),
          length_or(v, "distance_mm", std::numeric_limits<double>::infinity()), v["why"].text()};
}

void read_regions_report(const JsonValue& v, int n_patches, Design& design) {
  design.report.module_value = number_in(v["worth"], -kMaxWorth, kMaxWorth);
  if (design.regions.limits_entries()) {
    const JsonValue patches = v["entries_elsewhere"];
    for (std::size_t k = 0; k < patches.size(); ++k)
      design.report.entries_elsewhere.push_back(patches.at(k).integer(0, n_patches - 1));
  }
  const JsonValue uncovered = v["uncovered"];
  for (std::size_t k = 0; k < uncovered.size(); ++k) design.report.uncovered.push_back(read_uncovered(uncovered.at(k)));
}

}  // namespace

RegionFile read_region_file(const std::filesystem::path& path) {
  const json document = parse_json(read_text(path), path.string());
  const JsonValue v(document, path.string());
  only_keys(v, {"format", "version", "elsewhere", "regions"}, kRegionsPage);
  require_head(v, "triskin-regions", 1, std::string(kRegionsPage) + " describes it");
  RegionFile file;
  if (has(v, "elsewhere")) file.elsewhere = number_in(v["elsewhere"], -kMaxWeight, kMaxWeight);
  file.regions = read_list(v["regions"]);
  for (WantedRegion& w : file.regions) {
    if (!w.file.empty()) w.file = path.parent_path() / w.file;
  }
  if (file.regions.empty()) v["regions"].fail("must name at least one region");
  return file;
}

void write_regions(const Design& design, json& document) {
  if (design.regions.empty()) return;
  json list = json::array(), uncovered = json::array();
  for (const Region& r : design.regions.list) list.push_back(region_json(r));
  for (const Uncovered& u : design.report.uncovered) uncovered.push_back(uncovered_json(u));
  document["regions"] = {{"elsewhere", design.regions.elsewhere}, {"list", std::move(list)}};
  document["report"]["worth"] = design.report.module_value;
  document["report"]["uncovered"] = std::move(uncovered);
  if (design.regions.limits_entries()) document["report"]["entries_elsewhere"] = design.report.entries_elsewhere;
  for (std::size_t k = 0; k < design.layout.modules.size(); ++k)
    document["modules"][k]["keep_out_mm"] = design.layout.modules[k].keep_out_mm;
  for (std::size_t k = 0; k < design.alternatives.size(); ++k)
    document["alternatives"][k]["worth"] = design.alternatives[k].module_value;
}

void read_regions(const JsonValue& v, Design& design) {
  for (Alternative& a : design.alternatives) a.module_value = static_cast<double>(a.layout.modules.size());
  design.report.module_value = static_cast<double>(design.layout.modules.size());
  if (!has(v, "regions")) return;
  only_keys(v["regions"], {"elsewhere", "list"}, kRegionsPage);
  design.regions.elsewhere = number_in(v["regions"]["elsewhere"], -kMaxWeight, kMaxWeight);
  for (WantedRegion& wanted : read_list(v["regions"]["list"])) design.regions.list.push_back(std::move(wanted.region));
  read_regions_report(v["report"], static_cast<int>(design.patches.size()), design);
  for (std::size_t k = 0; k < design.layout.modules.size(); ++k)
    design.layout.modules[k].keep_out_mm = number_in(v["modules"].at(k)["keep_out_mm"], 0.0, kMaxLength_mm);
  for (std::size_t k = 0; k < design.alternatives.size(); ++k)
    design.alternatives[k].module_value = number_in(v["alternatives"].at(k)["worth"], -kMaxWorth, kMaxWorth);
}

}  // namespace triskin::design
