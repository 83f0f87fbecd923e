// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "alternatives_json.hpp"
#include "mesh_json.hpp"
#include "regions_json.hpp"
#include "triskin/base/files.hpp"
#include "triskin/design/design.hpp"
#include "triskin/design/design_text.hpp"
#include "triskin/design/module_number.hpp"

namespace triskin::design {
namespace {

using nlohmann::json;

json to_json(const Vec2& p) {
  return json::array({p.x(), p.y()});
}
json to_json(const Vec3& p) {
  return json::array({p.x(), p.y(), p.z()});
}

template <class Range>
json list(const Range& range) {
  json out = json::array();
  for (const auto& item : range) out.push_back(to_json(item));
  return out;
}

json side_json(const PartSide& side) {
  json j = {{"taken", side.taken}, {"certain", side.is_certain}, {"wall_mm", side.wall_mm}};
  if (!side.part.faces.empty()) j["part"] = mesh_json(side.part);
  return j;
}

json limits_json(const LayoutLimits& l, bool with_jumpers) {
  json limits = {{"edge_error_mm", l.edge_error_mm},
                 {"hinge_gap_mm", l.hinge_gap_mm},
                 {"center_gap_mm", l.center_gap_mm},
                 {"fold_rad", l.fold_rad},
                 {"penetration_mm", l.penetration_mm},
                 {"overrun_mm", l.overrun_mm},
                 {"lift_mm", l.lift_mm},
                 {"depth_mm", l.depth_mm}};
  if (std::isfinite(l.fold_away_rad)) limits["fold_away_rad"] = l.fold_away_rad;
  if (std::isfinite(l.fold_towards_rad)) limits["fold_towards_rad"] = l.fold_towards_rad;
  if (with_jumpers) limits["jumper_mm"] = l.jumper_mm;
  return limits;
}

json jumper_json(const Design& design, const Jumper& j) {
  return {{"kind", kJumperKindNames.name(j.kind)},
          {"modules", numbers_of(design, j.node)},
          {"sides", j.side},
          {"length_mm", j.length_mm},
          {"fold_rad", j.fold_rad}};
}

json piece_json(const PlacedPiece& p) {
  json holes = json::array();
  for (const auto& hole : p.piece.outline.holes) holes.push_back(list(hole));
  json flat = json::array();
  for (const auto& triangle : p.piece.flat) flat.push_back(list(triangle));
  const Placement& at = p.placement;
  return {{"outline", list(p.piece.outline.outer)},
          {"holes", std::move(holes)},
          {"faces", p.piece.faces},
          {"flat", std::move(flat)},
          {"max_edge_error_mm", p.piece.max_edge_error_mm},
          {"rms_edge_error_mm", p.piece.rms_edge_error_mm},
          {"placement", {{"x_mm", at.x_mm}, {"y_mm", at.y_mm}, {"theta_rad", at.theta_rad}}},
          {"modules", p.modules},
          {"upper_bound", p.upper_bound},
          {"proved", p.proved}};
}

json module_json(const Design& design, int id, const ModuleWiring& wiring) {
  const PlacedModule& m = design.layout.modules[static_cast<std::size_t>(id)];
  json taxels = json::array();
  for (const TaxelPose& t : taxels_of(m, wiring.routed.rotation)) {
    taxels.push_back({{"position", to_json(t.position_mm)}, {"normal", to_json(t.normal)}});
  }
  return {{"id", number_of(design, id)},
          {"island", m.island},
          {"i", m.tile.i},
          {"j", m.tile.j},
          {"up", m.tile.up},
          {"corners", list(m.corner_mm)},
          {"neighbours", numbers_of(design, m.neighbour)},
          {"edge_error_mm", m.edge_error_mm},
          {"hinge_gap_mm", m.hinge_gap_mm},
          {"fold_rad", m.fold_rad},
          {"center_gap_mm", m.center_gap_mm},
          {"edge_lift_mm", m.edge_lift_mm},
          {"edge_depth_mm", m.edge_depth_mm},
          {"penetration_mm", m.penetration_mm},
          {"overrun_mm", m.overrun_mm},
          {"bend_radius_mm", m.bend_radius_mm},
          {"patch", wiring.patch},
          {"line", wiring.routed.line},
          {"address", wiring.routed.address},
          {"rotation", wiring.routed.rotation},
          {"parent", number_of(design, wiring.routed.parent)},
          {"depth", wiring.routed.depth},
          {"taxels", std::move(taxels)}};
}

// Returns pairs of modules by number.
json pairs_json(const Design& design, const std::vector<std::array<int, 2>>& pairs) {
  json out = json::array();
  for (const auto& pair : pairs) out.push_back(numbers_of(design, pair));
  return out;
}

json failure_json(const Design& design, const FailureLoss& f) {
  return {{"module", number_of(design, f.node)}, {"other", number_of(design, f.other_node)},
          {"lost_strapped", f.lost_strapped},    {"lost_rerouted", f.lost_rerouted},
          {"lost_one_entry", f.lost_one_entry},  {"backup", pairs_json(design, f.backup_tree)}};
}

json patch_json(const Design& design, int id) {
  const Patch& p = design.patches[static_cast<std::size_t>(id)];
  json modules = json::array();
  for (const RoutedModule& m : p.modules) modules.push_back(number_of(design, m.node));
  json failures = json::array();
  for (const FailureLoss& f : p.failures) failures.push_back(failure_json(design, f));
  return {{"id", id},
          {"node_address", id + 1},
          {"entry", number_of(design, p.entry)},
          {"second_entry", number_of(design, p.second_entry)},
          {"second_entry_side", p.second_entry_side},
          {"modules", std::move(modules)},
          {"cut_joints", pairs_json(design, p.cut_joints)},
          {"line_hops", p.line_hops},
          {"max_depth", p.max_depth},
          {"failures", std::move(failures)}};
}

json report_json(const Design& design) {
  const Design::Report& r = design.report;
  json report = {{"area_cm2", r.area_cm2},
                 {"coverage", r.coverage},
                 {"upper_bound", r.upper_bound},
                 {"patches_lower_bound", r.patches_lower_bound},
                 {"max_edge_error_mm", r.max_edge_error_mm},
                 {"max_hinge_gap_mm", r.max_hinge_gap_mm},
                 {"max_center_gap_mm", r.max_center_gap_mm},
                 {"max_edge_lift_mm", r.max_edge_lift_mm},
                 {"max_edge_depth_mm", r.max_edge_depth_mm},
                 {"seconds", r.seconds}};
  if (!design.layout.jumpers.empty()) report["jumpers_lower_bound"] = r.jumpers_lower_bound;
  if (design.layout.corner_cut_mm > 0.0) report["coverage_cut"] = r.coverage_cut;
  return report;
}

json source_json(const Design& design) {
  json source = {{"file", design.source_file}, {"scale_to_mm", design.scale_to_mm}};
  if (!design.part) return source;
  source["part"] = {{"faces", design.part->faces},
                    {"face_count", design.part->face_count},
                    {"deviation_mm", design.part->deviation_mm},
                    {"selection", json::parse(design.part->selection)}};
  return source;
}

json modules_json(const Design& design) {
  const std::vector<ModuleWiring> wiring = wiring_of(design);
  json modules = json::array();
  for (std::size_t k = 0; k < design.layout.modules.size(); ++k) {
    const PlacedModule& m = design.layout.modules[k];
    modules.push_back(module_json(design, static_cast<int>(k), wiring[k]));
    // The file has no key for kinds if all modules are standard.
    if (!design.kinds.empty()) modules.back()["kind"] = kind_of(design.kinds, m.kind).name;
  }
  return modules;
}

json pieces_json(const Design& design) {
  json pieces = json::array();
  for (const PlacedPiece& piece : design.pieces) pieces.push_back(piece_json(piece));
  return pieces;
}

json patches_json(const Design& design) {
  json patches = json::array();
  for (const layout::PatchIndex p : patches_of(design)) patches.push_back(patch_json(design, p));
  return patches;
}

json refused_json(const ModuleLayout& layout) {
  json refused = json::object();
  for (const auto& [limit, count] : layout.refused) refused[limit] = count;
  return refused;
}

// Returns the keys that every file has.
json document_of(const Design& design) {
  const bool with_jumpers = !design.layout.jumpers.empty();
  return {{"format", "triskin-design"},
          {"version", with_jumpers ? Design::kJumperVersion : Design::kVersion},
          {"name", design.name},
          {"design_id", fmt::format("{:016x}", design.design_id)},
          {"seed", design.seed},
          {"source", source_json(design)},
          {"surface", mesh_json(design.surface)},
          {"limits", limits_json(design.limits, with_jumpers)},
          {"method", kLayoutMethodNames.name(design.layout.method)},
          {"islands", design.layout.islands},
          {"pieces", pieces_json(design)},
          {"modules", modules_json(design)},
          {"patches", patches_json(design)},
          {"refused", refused_json(design.layout)},
          {"report", report_json(design)}};
}

}  // namespace

std::string design_text(const Design& design) {
  json file = document_of(design);
  if (design.side) file["side"] = side_json(*design.side);
  // A design of whole triangles has no such key.
  if (design.layout.corner_cut_mm > 0.0) file["corner_cut_mm"] = design.layout.corner_cut_mm;
  if (!design.kinds.empty()) file["kinds"] = kind_plan_json(design.kinds);
  // Where the last numbers are still in use, the next one follows from them.
  const std::vector<int> numbers = all_numbers(design.layout);
  if (!numbers.empty() && design.next_number > numbers.back() + 1) file["next_module"] = design.next_number;
  write_alternatives(design, file);
  write_regions(design, file);
  for (const Jumper& j : design.layout.jumpers) file["jumpers"].push_back(jumper_json(design, j));
  // The file name may contain bytes that are not UTF-8, so the writer replaces them.
  return file.dump(-1, ' ', false, json::error_handler_t::replace) + "\n";
}

void write_design(const std::filesystem::path& path, const Design& design) {
  write_output(path, design_text(design));
}

}  // namespace triskin::design
