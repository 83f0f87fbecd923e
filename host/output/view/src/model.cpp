// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <nlohmann/json.hpp>
#include <numbers>

#include "triskin/design/module_number.hpp"
#include "triskin/layout/module.hpp"
#include "triskin/view/page.hpp"

namespace triskin::view {
namespace {

using nlohmann::json;

// A screen cannot show less than 10 µm, and fewer digits halve the size of the page.
double rounded(double value) {
  return std::round(value * 100.0) / 100.0;
}

void append(json& list, const design::Vec3& p) {
  for (int k = 0; k < 3; ++k) list.push_back(rounded(p[k]));
}

json surface_of(const design::Mesh& mesh) {
  json vertices = json::array(), faces = json::array();
  for (const auto& v : mesh.vertices) append(vertices, v);
  for (const auto& f : mesh.faces) {
    for (const int corner : f) faces.push_back(corner);
  }
  return {{"vertices", std::move(vertices)}, {"faces", std::move(faces)}};
}

// The page shows angles in degrees because people read them more easily.
double degrees(double rad) {
  return rad * 180.0 / std::numbers::pi;
}

// Each metric with its limit (0: it has none), in the order of "metrics" of a module.
json metrics_of(const design::LayoutLimits& l) {
  const auto row = [](const char* name, const char* unit, double limit) {
    return json{{"name", name}, {"unit", unit}, {"limit", rounded(limit)}};
  };
  const auto limit_or_none = [](double limit) { return std::isfinite(limit) ? limit : 0.0; };
  return json::array({row("edge error", "mm", l.edge_error_mm), row("hinge gap", "mm", l.hinge_gap_mm),
                      row("fold", "°", degrees(l.fold_rad)), row("centre gap", "mm", l.center_gap_mm),
                      row("edge depth", "mm", limit_or_none(l.depth_mm)), row("penetration", "mm", l.penetration_mm),
                      row("overrun", "mm", l.overrun_mm), row("edge lift", "mm", limit_or_none(l.lift_mm))});
}

json metrics_of(const design::PlacedModule& m) {
  json list = json::array();
  for (const double value : {m.edge_error_mm, std::ranges::max(m.hinge_gap_mm), degrees(std::ranges::max(m.fold_rad)),
                             m.center_gap_mm, m.edge_depth_mm, m.penetration_mm, m.overrun_mm, m.edge_lift_mm})
    list.push_back(std::round(value * 1000.0) / 1000.0);
  return list;
}

json module_of(const design::PlacedModule& m, const design::ModuleWiring& wiring, design::ModuleNumber number) {
  json corners = json::array(), taxels = json::array();
  for (const auto& c : m.corner_mm) append(corners, c);
  for (const auto& t : design::taxels_of(m, wiring.routed.rotation)) append(taxels, t.position_mm);
  const design::RoutedModule& r = wiring.routed;
  return {{"number", number},
          {"corners", std::move(corners)},
          {"taxels", std::move(taxels)},
          {"tile", {m.tile.i, m.tile.j, m.tile.up ? 1 : 0}},
          {"island", m.island},
          {"neighbours", m.neighbour},
          {"patch", wiring.patch},
          {"line", r.line},
          {"address", r.address},
          {"rotation", r.rotation},
          {"parent", wiring.patch < 0 ? -1 : r.parent},
          {"depth", r.depth},
          {"metrics", metrics_of(m)}};
}

json patch_of(const design::Design& design, std::size_t index, bool is_switched) {
  const design::Patch& p = design.patches[index];
  json failures = json::array();
  for (const auto& f : is_switched ? p.failures : std::vector<design::FailureLoss>{}) {
    failures.push_back({{"module", f.node},
                        {"other", f.other_node},
                        {"lost", f.lost_strapped},
                        {"lost_rerouted", f.lost_rerouted},
                        {"backup", f.backup_tree}});
  }
  return {{"node", design::node_address_of(design, layout::PatchIndex{index})},
          {"entry", p.entry},
          {"second_entry", is_switched ? p.second_entry : -1},
          {"cut_joints", p.cut_joints},
          {"max_depth", p.max_depth},
          {"failures", std::move(failures)}};
}

json jumpers_of(const design::Design& design) {
  json list = json::array();
  for (const auto& j : design.layout.jumpers)
    list.push_back({{"name", design::jumper_name(design, j)},
                    {"modules", j.node},
                    {"sides", j.side},
                    {"length_mm", rounded(j.length_mm)}});
  return list;
}

// Describes the side of the wall that was taken, the thickness of the wall under each module and the rest of the part;
// null if the design contains no part.
json side_of(const design::Design& design) {
  if (!design.side) return nullptr;
  json wall = json::array();
  for (const double mm : wall_under_modules(design)) wall.push_back(rounded(mm));
  return {{"taken", design.side->taken},
          {"mean_mm", rounded(design.side->wall_mm)},
          {"wall_mm", std::move(wall)},
          {"left_out", surface_of(left_out_of_part(design))}};
}

json covers_of(const Notes& notes) {
  json list = json::array();
  for (const CoverNote& c : notes.covers) {
    list.push_back({{"name", c.name},
                    {"first_module", c.first_module},
                    {"first_patch", c.first_patch},
                    {"first_island", c.first_island},
                    {"modules", c.modules},
                    {"area_cm2", rounded(c.area_cm2)},
                    {"coverage", rounded(c.coverage)}});
  }
  return list;
}

// Classifies each module as kept, added or removed.
json changes_of(const Changes& changes) {
  constexpr std::array kNames{"kept", "added", "removed"};
  json list = json::array();
  for (const ModuleChange& c : changes.modules)
    list.push_back({{"what", kNames.at(static_cast<std::size_t>(c.kind))}, {"other", c.other}});
  return list;
}

json findings_of(const Notes& notes) {
  json list = json::array();
  for (const Finding& f : notes.findings)
    list.push_back({{"module", f.module}, {"patch", f.patch}, {"text", f.text}, {"remedy", f.remedy}});
  return list;
}

}  // namespace

std::vector<double> counts_per_kpa_of(const design::SkinCalibration& calibration) {
  std::vector<double> list;
  for (std::size_t k = 0; calibration.complete() && k < calibration.modules(); ++k) {
    for (int t = 0; t < layout::kTaxelsPerModule; ++t)
      list.push_back(rounded(calibration.counts_per_kpa({layout::ModuleId{k}, layout::TaxelIndex{t}})));
  }
  return list;
}

std::string model_json(const design::Design& design, bool recording, const Notes& notes) {
  const auto wiring = design::wiring_of(design);
  json modules = json::array(), patches = json::array();
  for (std::size_t k = 0; k < design.layout.modules.size(); ++k) {
    modules.push_back(module_of(design.layout.modules[k], wiring[k], design::number_of(design, static_cast<int>(k))));
    if (!design.kinds.empty())
      modules.back()["kind"] = design::kind_of(design.kinds, design.layout.modules[k].kind).name;
  }
  for (std::size_t p = 0; p < design.patches.size(); ++p)
    patches.push_back(patch_of(design, p, notes.has_switched_modules));
  const json model = {
      {"name", design.name},
      {"design_id", fmt::format("{:016x}", design.design_id)},
      {"side_mm", design::kSide_mm},
      {"corner_cut_mm", design.layout.corner_cut_mm},
      {"jumpers", jumpers_of(design)},
      {"recording", recording},
      {"islands", design.layout.islands},
      {"area_cm2", rounded(design.report.area_cm2)},
      {"coverage", rounded(design.report.coverage)},
      {"temperature_pads", layout::kTemperaturePads},
      {"metrics", metrics_of(design.limits)},
      {"surface", surface_of(design.surface)},
      {"side", side_of(design)},
      {"covers", covers_of(notes)},
      {"findings", findings_of(notes)},
      {"live", notes.has_live_skin},
      {"changes", changes_of(notes.changes)},
      {"switched", notes.has_switched_modules},
      {"counts_per_kpa", notes.counts_per_kpa},
      {"before", {{"modules", notes.changes.before_modules}, {"vertices", notes.changes.before_vertices}}},
      {"modules", std::move(modules)},
      {"patches", std::move(patches)}};
  // A name from a file must not end the script that holds it in page_html.
  std::string text = model.dump(-1, ' ', true, json::error_handler_t::replace);
  for (const auto& [bracket, escape] : {std::pair{'<', "\\u003c"}, std::pair{'>', "\\u003e"}}) {
    for (std::size_t at = text.find(bracket); at != std::string::npos; at = text.find(bracket, at))
      text.replace(at, 1, escape);
  }
  return text;
}

}  // namespace triskin::view
