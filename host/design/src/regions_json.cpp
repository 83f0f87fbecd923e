// SPDX-License-Identifier: GPL-3.0-or-later
#include "regions_json.hpp"

#include "triskin/base/text_file.hpp"
#include "triskin/design/design_text.hpp"
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

json region_json(const Region& r) {
  json j = {{"name", r.name}};
  if (const auto* s = std::get_if<Sphere>(&r.shape))
    j["sphere"] = {{"center_mm", point(s->center_mm)}, {"radius_mm", s->radius_mm}};
  else if (const auto* b = std::get_if<Box>(&r.shape))
    j["box"] = {{"low_mm", point(b->low_mm)}, {"high_mm", point(b->high_mm)}};
  else
    j["faces"] = std::get<FaceSet>(r.shape).faces;
  if (r.weight) j["weight"] = *r.weight;
  if (r.free) j["free"] = true;
  if (r.cover) {
    j["cover"] = true;
    j["within_mm"] = r.within_mm;
  }
  return j;
}

// A region must have exactly one shape.
WantedRegion read_region(const JsonValue& v) {
  only_keys(v, {"name", "sphere", "box", "faces", "group", "weight", "cover", "free", "within_mm"}, kRegionsPage);
  WantedRegion wanted;
  Region& r = wanted.region;
  r.name = v["name"].text();
  int shapes = 0;
  for (const char* shape : {"sphere", "box", "faces", "group"}) shapes += has(v, shape) ? 1 : 0;
  if (shapes != 1) v.fail("needs one of \"sphere\", \"box\", \"faces\" and \"group\"");
  if (has(v, "sphere")) {
    only_keys(v["sphere"], {"center_mm", "radius_mm"}, kRegionsPage);
    r.shape = Sphere{vec3(v["sphere"]["center_mm"]), number_in(v["sphere"]["radius_mm"], 0.0, kMaxLength_mm)};
  } else if (has(v, "box")) {
    only_keys(v["box"], {"low_mm", "high_mm"}, kRegionsPage);
    r.shape = Box{vec3(v["box"]["low_mm"]), vec3(v["box"]["high_mm"])};
  } else {
    FaceSet set;
    if (has(v, "group")) wanted.group = v["group"].text();
    for (std::size_t k = 0; has(v, "faces") && k < v["faces"].size(); ++k)
      set.faces.push_back(v["faces"].at(k).integer(0, 2'000'000'000));
    r.shape = std::move(set);
  }
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

}  // namespace

RegionFile read_region_file(const std::filesystem::path& path) {
  const json document = parse_json(read_text(path), path.string());
  const JsonValue v(document, path.string(), "");
  only_keys(v, {"format", "version", "elsewhere", "regions"}, kRegionsPage);
  if (v["format"].text() != "triskin-regions") v["format"].fail("must be \"triskin-regions\"");
  if (v["version"].integer(0, 1000) != 1) v["version"].fail("must be 1");
  RegionFile file;
  if (has(v, "elsewhere")) file.elsewhere = number_in(v["elsewhere"], -kMaxWeight, kMaxWeight);
  file.regions = read_list(v["regions"]);
  if (file.regions.empty()) v["regions"].fail("must name at least one region");
  return file;
}

void write_regions(const Design& design, json& document) {
  if (design.regions.empty()) return;
  json list = json::array(), uncovered = json::array();
  for (const Region& r : design.regions.list) list.push_back(region_json(r));
  for (const Uncovered& u : design.report.uncovered) {
    json j = {{"region", u.region}, {"share", u.share}, {"place_mm", point(u.place_mm)}, {"why", u.why}};
    if (std::isfinite(u.distance_mm)) j["distance_mm"] = u.distance_mm;
    uncovered.push_back(std::move(j));
  }
  document["regions"] = {{"elsewhere", design.regions.elsewhere}, {"list", std::move(list)}};
  document["report"]["worth"] = design.report.module_value;
  document["report"]["uncovered"] = std::move(uncovered);
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
  design.report.module_value = number_in(v["report"]["worth"], -kMaxWorth, kMaxWorth);
  const JsonValue uncovered = v["report"]["uncovered"];
  for (std::size_t k = 0; k < uncovered.size(); ++k) {
    const JsonValue u = uncovered.at(k);
    only_keys(u, {"region", "share", "place_mm", "distance_mm", "why"}, kRegionsPage);
    design.report.uncovered.push_back({u["region"].text(), number_in(u["share"], 0.0, 1.0 + 1e-9), vec3(u["place_mm"]),
                                       has(u, "distance_mm") ? number_in(u["distance_mm"], 0.0, kMaxLength_mm)
                                                             : std::numeric_limits<double>::infinity(),
                                       u["why"].text()});
  }
  for (std::size_t k = 0; k < design.layout.modules.size(); ++k)
    design.layout.modules[k].keep_out_mm = number_in(v["modules"].at(k)["keep_out_mm"], 0.0, kMaxLength_mm);
  for (std::size_t k = 0; k < design.alternatives.size(); ++k)
    design.alternatives[k].module_value = number_in(v["alternatives"].at(k)["worth"], -kMaxWorth, kMaxWorth);
}

}  // namespace triskin::design
