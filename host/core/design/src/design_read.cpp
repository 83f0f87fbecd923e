// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <optional>

#include "alternatives_json.hpp"
#include "mesh_json.hpp"
#include "regions_json.hpp"
#include "triskin/base/error.hpp"
#include "triskin/base/file_kind.hpp"
#include "triskin/base/json_cause.hpp"
#include "triskin/base/text_file.hpp"
#include "triskin/design/design.hpp"
#include "triskin/design/design_text.hpp"
#include "triskin/design/file_head.hpp"
#include "triskin/design/json_fields.hpp"
#include "triskin/design/module_number.hpp"
#include "triskin/design/outline.hpp"

namespace triskin::design {
namespace {

constexpr const char* kDesignPage = "docs/design_file.md";

double number(const JsonValue& v) {
  return number_in(v, -kMaxLength_mm, kMaxLength_mm);
}

// Reads a number that cannot be negative, such as an error, a gap, an angle or an area.
double magnitude(const JsonValue& v) {
  return number_in(v, 0.0, kMaxLength_mm);
}

Vec2 vec2(const JsonValue& v) {
  v.require_size(2);
  return {number(v.at(0)), number(v.at(1))};
}

template <class Read>
auto list(const JsonValue& v, Read read) {
  std::vector<decltype(read(v))> out;
  out.reserve(v.size());
  for (std::size_t k = 0; k < v.size(); ++k) out.push_back(read(v.at(k)));
  return out;
}

template <class Read>
auto triple(const JsonValue& v, Read read) {
  v.require_size(3);
  return std::array{read(v.at(0)), read(v.at(1)), read(v.at(2))};
}

auto index_below(std::size_t n) {
  return [n](const JsonValue& v) { return v.integer(0, static_cast<int>(n) - 1); };
}

// Modules are named by their numbers; the design in memory has their indices.
using Numbers = std::vector<int>;

Numbers read_numbers(const JsonValue& modules) {
  Numbers numbers;
  numbers.reserve(modules.size());
  for (std::size_t k = 0; k < modules.size(); ++k) {
    const JsonValue id = modules.at(k)["id"];
    const int number = id.integer(0, kMaxModuleNumber);
    if (!numbers.empty() && number <= numbers.back())
      id.fail(fmt::format("is {} after {}; the numbers of modules must ascend", number, numbers.back()));
    numbers.push_back(number);
  }
  return numbers;
}

auto module_in(const Numbers& numbers) {
  return [&numbers](const JsonValue& v) {
    const int number = v.integer(0, kMaxModuleNumber);
    const auto found = std::ranges::lower_bound(numbers, number);
    if (found == numbers.end() || *found != number) v.fail(fmt::format("names module {}, which is not there", number));
    return static_cast<int>(found - numbers.begin());
  };
}

auto module_or_none(const Numbers& numbers) {
  return [&numbers](const JsonValue& v) { return v.integer(-1, kMaxModuleNumber) < 0 ? -1 : module_in(numbers)(v); };
}

void read_limits(const JsonValue& v, LayoutLimits& l) {
  only_keys(v,
            {"edge_error_mm", "hinge_gap_mm", "center_gap_mm", "fold_rad", "penetration_mm", "overrun_mm", "jumper_mm",
             "lift_mm", "depth_mm", "fold_away_rad", "fold_towards_rad"},
            kDesignPage);
  l.edge_error_mm = magnitude(v["edge_error_mm"]);
  l.hinge_gap_mm = magnitude(v["hinge_gap_mm"]);
  l.center_gap_mm = magnitude(v["center_gap_mm"]);
  l.fold_rad = magnitude(v["fold_rad"]);
  l.penetration_mm = magnitude(v["penetration_mm"]);
  l.overrun_mm = magnitude(v["overrun_mm"]);
  l.lift_mm = magnitude(v["lift_mm"]);
  l.depth_mm = magnitude(v["depth_mm"]);
  if (has(v, "jumper_mm")) l.jumper_mm = magnitude(v["jumper_mm"]);
  if (has(v, "fold_away_rad")) l.fold_away_rad = magnitude(v["fold_away_rad"]);
  if (has(v, "fold_towards_rad")) l.fold_towards_rad = magnitude(v["fold_towards_rad"]);
}

void read_jumper_ends(const JsonValue& modules, const JsonValue& sides, const Numbers& numbers, Jumper& j) {
  modules.require_size(2);
  sides.require_size(2);
  for (std::size_t k = 0; k < 2; ++k) {
    j.node[k] = module_in(numbers)(modules.at(k));
    j.side[k] = sides.at(k).integer(0, 2);
  }
  if (j.node[0] >= j.node[1]) modules.fail("must name two modules, the lesser number first");
}

Jumper read_jumper(const JsonValue& v, const Numbers& numbers) {
  only_keys(v, {"kind", "modules", "sides", "length_mm", "fold_rad"}, kDesignPage);
  Jumper j;
  const auto kind = kJumperKindNames.value(v["kind"].text());
  if (!kind) v["kind"].fail("must be " + kJumperKindNames.list());
  j.kind = *kind;
  read_jumper_ends(v["modules"], v["sides"], numbers, j);
  j.length_mm = magnitude(v["length_mm"]);
  j.fold_rad = number(v["fold_rad"]);
  return j;
}

PartSide read_side(const JsonValue& v) {
  only_keys(v, {"taken", "certain", "wall_mm", "part"}, kDesignPage);
  PartSide side;
  side.taken = v["taken"].text();
  side.is_certain = v["certain"].boolean();
  side.wall_mm = number(v["wall_mm"]);
  if (has(v, "part")) side.part = read_mesh_json(v["part"]);
  return side;
}

Piece read_flat_piece(const JsonValue& v, std::size_t n_faces) {
  Piece piece;
  piece.outline.outer = list(v["outline"], vec2);
  piece.outline.holes = list(v["holes"], [](const JsonValue& hole) { return list(hole, vec2); });
  piece.faces = list(v["faces"], [&](const JsonValue& f) { return FaceIndex(index_below(n_faces)(f)); });
  piece.flat = list(v["flat"], [](const JsonValue& t) { return triple(t, vec2); });
  if (piece.flat.size() != piece.faces.size()) v["flat"].fail("must have as many elements as \"faces\"");
  piece.max_edge_error_mm = magnitude(v["max_edge_error_mm"]);
  piece.rms_edge_error_mm = magnitude(v["rms_edge_error_mm"]);
  return piece;
}

Placement read_placement(const JsonValue& v) {
  only_keys(v, {"x_mm", "y_mm", "theta_rad"}, kDesignPage);
  return {number(v["x_mm"]), number(v["y_mm"]), number(v["theta_rad"])};
}

PlacedPiece read_piece(const JsonValue& v, std::size_t n_faces) {
  only_keys(v,
            {"outline", "holes", "faces", "flat", "max_edge_error_mm", "rms_edge_error_mm", "placement", "modules",
             "upper_bound", "proved"},
            kDesignPage);
  PlacedPiece p;
  p.piece = read_flat_piece(v, n_faces);
  p.placement = read_placement(v["placement"]);
  p.modules = v["modules"].integer(0, kMaxCount);
  p.upper_bound = v["upper_bound"].integer(0, kMaxCount);
  p.proved = v["proved"].boolean();
  return p;
}

const std::initializer_list<std::string_view> kModuleKeys{"id",
                                                          "island",
                                                          "i",
                                                          "j",
                                                          "up",
                                                          "corners",
                                                          "neighbours",
                                                          "edge_error_mm",
                                                          "hinge_gap_mm",
                                                          "fold_rad",
                                                          "center_gap_mm",
                                                          "edge_lift_mm",
                                                          "edge_depth_mm",
                                                          "penetration_mm",
                                                          "overrun_mm",
                                                          "keep_out_mm",
                                                          "bend_radius_mm",
                                                          "patch",
                                                          "line",
                                                          "address",
                                                          "rotation",
                                                          "parent",
                                                          "depth",
                                                          "taxels",
                                                          "kind"};

void read_deviations(const JsonValue& v, PlacedModule& m) {
  m.edge_error_mm = magnitude(v["edge_error_mm"]);
  m.hinge_gap_mm = triple(v["hinge_gap_mm"], magnitude);
  m.fold_rad = triple(v["fold_rad"], magnitude);
  m.center_gap_mm = magnitude(v["center_gap_mm"]);
  m.edge_lift_mm = magnitude(v["edge_lift_mm"]);
  m.edge_depth_mm = magnitude(v["edge_depth_mm"]);
  m.penetration_mm = magnitude(v["penetration_mm"]);
  m.overrun_mm = magnitude(v["overrun_mm"]);
}

PlacedModule read_module(const JsonValue& v, const Numbers& numbers) {
  only_keys(v, kModuleKeys, kDesignPage);
  PlacedModule m;
  m.island = v["island"].integer(0, kMaxCount);
  m.tile = {v["i"].integer(-kMaxLattice, kMaxLattice), v["j"].integer(-kMaxLattice, kMaxLattice), v["up"].boolean()};
  m.corner_mm = triple(v["corners"], vec3);
  m.neighbour = triple(v["neighbours"], module_or_none(numbers));
  read_deviations(v, m);
  // The radius has no upper bound, because a place can be almost flat.
  m.bend_radius_mm = v["bend_radius_mm"].number();
  if (m.bend_radius_mm < 0.0) v["bend_radius_mm"].fail("must not be negative");
  return m;
}

RoutedModule read_routed(const JsonValue& v, int node, const Numbers& numbers) {
  return {node,
          module_or_none(numbers)(v["parent"]),
          v["rotation"].integer(0, 2),
          v["line"].integer(0, 3),
          v["address"].integer(0, 3),
          v["depth"].integer(0, kMaxCount)};
}

std::array<int, 2> pair_of(const JsonValue& v, const Numbers& numbers) {
  v.require_size(2);
  return {module_in(numbers)(v.at(0)), module_in(numbers)(v.at(1))};
}

// Reads a child and its parent; −1 as parent of the second entry is the controller.
std::array<int, 2> backup_of(const JsonValue& v, const Numbers& numbers) {
  v.require_size(2);
  return {module_in(numbers)(v.at(0)), module_or_none(numbers)(v.at(1))};
}

FailureLoss read_failure(const JsonValue& v, const Numbers& numbers) {
  only_keys(v, {"module", "other", "lost_strapped", "lost_rerouted", "lost_one_entry", "backup"}, kDesignPage);
  FailureLoss f;
  f.node = module_in(numbers)(v["module"]);
  f.other_node = module_or_none(numbers)(v["other"]);
  f.lost_strapped = v["lost_strapped"].integer(0, kMaxCount);
  f.lost_rerouted = v["lost_rerouted"].integer(0, kMaxCount);
  f.lost_one_entry = v["lost_one_entry"].integer(0, kMaxCount);
  f.backup_tree = list(v["backup"], [&](const JsonValue& b) { return backup_of(b, numbers); });
  return f;
}

void read_entries(const JsonValue& v, const Numbers& numbers, Patch& patch) {
  patch.entry = module_in(numbers)(v["entry"]);
  patch.second_entry = module_or_none(numbers)(v["second_entry"]);
  const bool has_second = patch.second_entry >= 0;
  patch.second_entry_side = v["second_entry_side"].integer(has_second ? 0 : -1, has_second ? 2 : -1);
}

// A calibration in a controller has 16 bits for the number of its patch.
constexpr int kMaxPatch = 0xFFFF;

Patch read_patch(const JsonValue& v, int id, const JsonValue& modules, const Numbers& numbers) {
  only_keys(v,
            {"id", "node_address", "entry", "second_entry", "second_entry_side", "modules", "cut_joints", "line_hops",
             "max_depth", "failures"},
            kDesignPage);
  if (v["node_address"].integer(0, kMaxCount) != id + 1) v["node_address"].fail("must be id + 1");
  Patch patch;
  read_entries(v, numbers, patch);
  for (const int node : list(v["modules"], module_in(numbers))) {
    patch.modules.push_back(read_routed(modules.at(static_cast<std::size_t>(node)), node, numbers));
  }
  patch.cut_joints = list(v["cut_joints"], [&](const JsonValue& j) { return pair_of(j, numbers); });
  patch.line_hops = v["line_hops"].integer(0, kMaxCount);
  patch.max_depth = v["max_depth"].integer(0, kMaxCount);
  patch.failures = list(v["failures"], [&](const JsonValue& f) { return read_failure(f, numbers); });
  return patch;
}

// Files without the key have uncut triangles.
double read_corner_cut(const JsonValue& v) {
  if (!v.raw().contains("corner_cut_mm")) return 0.0;
  const double cut_mm = number(v["corner_cut_mm"]);
  if (!(cut_mm > 0.0 && cut_mm <= kMaxCornerCut_mm))
    v["corner_cut_mm"].fail(fmt::format("must be above 0 and at most {}", kMaxCornerCut_mm));
  return cut_mm;
}

// Files without the key have only modules of the standard kind.
void read_kinds(const JsonValue& v, Design& d) {
  d.kinds = kind_plan_of(v["kinds"]);
  for (std::size_t k = 0; k < d.layout.modules.size(); ++k) {
    const JsonValue name = v["modules"].at(k)["kind"];
    const std::optional<int> kind = number_of_kind(d.kinds, name.text());
    if (!kind) name.fail(fmt::format("\"{}\" is not a kind of this design", name.text()));
    d.layout.modules[k].kind = *kind;
  }
}

LayoutMethod read_method(const JsonValue& v) {
  const auto method = kLayoutMethodNames.value(v.text());
  if (!method) v.fail("must be " + kLayoutMethodNames.list());
  return *method;
}

void read_largest_deviations(const JsonValue& v, Design::Report& r) {
  r.max_edge_error_mm = magnitude(v["max_edge_error_mm"]);
  r.max_hinge_gap_mm = magnitude(v["max_hinge_gap_mm"]);
  r.max_center_gap_mm = magnitude(v["max_center_gap_mm"]);
  r.max_edge_lift_mm = magnitude(v["max_edge_lift_mm"]);
  r.max_edge_depth_mm = magnitude(v["max_edge_depth_mm"]);
}

Design::Report read_report(const JsonValue& v) {
  only_keys(v,
            {"area_cm2", "coverage", "upper_bound", "patches_lower_bound", "max_edge_error_mm", "max_hinge_gap_mm",
             "max_center_gap_mm", "seconds", "max_edge_lift_mm", "max_edge_depth_mm", "jumpers_lower_bound",
             "coverage_cut", "worth", "uncovered", "entries_elsewhere"},
            kDesignPage);
  Design::Report r;
  r.area_cm2 = magnitude(v["area_cm2"]);
  r.coverage = magnitude(v["coverage"]);
  r.upper_bound = v["upper_bound"].integer(0, kMaxCount);
  r.patches_lower_bound = v["patches_lower_bound"].integer(0, kMaxCount);
  r.seconds = magnitude(v["seconds"]);
  read_largest_deviations(v, r);
  if (has(v, "jumpers_lower_bound")) r.jumpers_lower_bound = v["jumpers_lower_bound"].integer(0, kMaxCount);
  r.coverage_cut = v.raw().contains("coverage_cut") ? magnitude(v["coverage_cut"]) : r.coverage;
  return r;
}

// These keys repeat facts that follow from other values of the file.
constexpr const char* kDerived =
    "does not follow from the corners and the wiring: the file was changed after it was made; make the design again";

// Returns true if `j` is three numbers that equal `expected` up to the rounding of another computer.
bool is_close(const nlohmann::json& j, const Vec3& expected) {
  constexpr double kRounding_mm = 1e-6, kRelativeRounding = 1e-9;
  if (!j.is_array() || j.size() != 3) return false;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    if (!j[axis].is_number()) return false;
    const double x = expected[static_cast<int>(axis)];
    if (!(std::abs(j[axis].get<double>() - x) <= kRounding_mm + kRelativeRounding * std::abs(x))) return false;
  }
  return true;
}

bool is_taxel(const nlohmann::json& j, const TaxelPose& expected) {
  if (!j.is_object() || j.size() != 2 || !j.contains("position") || !j.contains("normal")) return false;
  return is_close(j["position"], expected.position_mm) && is_close(j["normal"], expected.normal);
}

void require_derived(const JsonValue& v, const Design& d, int id, const ModuleWiring& wiring) {
  const auto is = [&v](const char* key, int expected) {
    if (v[key].integer(-1, kMaxCount) != expected) v[key].fail(fmt::format("must be {}, as the patches say", expected));
  };
  is("patch", wiring.patch);
  is("line", wiring.routed.line);
  is("address", wiring.routed.address);
  is("rotation", wiring.routed.rotation);
  is("parent", number_of(d, wiring.routed.parent).value);
  is("depth", wiring.routed.depth);
  const auto poses = taxels_of(d.layout.modules[static_cast<std::size_t>(id)], wiring.routed.rotation);
  const JsonValue taxels = v["taxels"];
  taxels.require_size(poses.size());
  for (std::size_t t = 0; t < poses.size(); ++t) {
    if (!is_taxel(taxels.raw()[t], poses[t])) taxels.at(t).fail(kDerived);
  }
}

void check_head(const JsonValue& v) {
  require_head(v, "triskin-design", has(v, "jumpers") ? Design::kJumperVersion : Design::kVersion,
               "make the design again, or use the release that wrote it");
  only_keys(v, {"format", "version", "name",   "design_id",     "seed",    "source",  "surface",      "limits",
                "method", "islands", "pieces", "modules",       "patches", "refused", "report",       "side",
                "kinds",  "jumpers", "price",  "corner_cut_mm", "taken",   "regions", "alternatives", "next_module"},
            kDesignPage);
}

std::optional<Design::PartSource> read_part_source(const JsonValue& source) {
  if (!has(source, "part")) return std::nullopt;
  const JsonValue v = source["part"];
  only_keys(v, {"faces", "face_count", "deviation_mm", "selection"}, kDesignPage);
  Design::PartSource part;
  part.face_count = v["face_count"].integer(1, kMaxCount);
  part.deviation_mm = magnitude(v["deviation_mm"]);
  part.faces = list(v["faces"], [&](const JsonValue& f) { return BrepFaceIndex(f.integer(0, part.face_count - 1)); });
  if (!v["selection"].raw().is_object()) v["selection"].fail("must be an object");
  part.selection = v["selection"].raw().dump();
  return part;
}

void read_source(const JsonValue& v, Design& d) {
  only_keys(v, {"file", "scale_to_mm", "part"}, kDesignPage);
  d.source_file = v["file"].text();
  d.scale_to_mm = number(v["scale_to_mm"]);
  d.part = read_part_source(v);
}

void read_layout(const JsonValue& v, Design& d) {
  d.layout.method = read_method(v["method"]);
  d.layout.corner_cut_mm = read_corner_cut(v);
  d.layout.islands = v["islands"].integer(0, kMaxCount);
  const JsonValue modules = v["modules"];
  const Numbers numbers = read_numbers(modules);
  d.layout.modules = list(modules, [&](const JsonValue& m) { return read_module(m, numbers); });
  set_numbers(d.layout, numbers);
  if (has(v, "next_module")) d.next_number = v["next_module"].integer(next_number(d), kMaxModuleNumber + 1);
  if (has(v, "kinds")) read_kinds(v, d);
  if (has(v, "jumpers"))
    d.layout.jumpers = list(v["jumpers"], [&](const JsonValue& j) { return read_jumper(j, numbers); });
}

void read_wiring(const JsonValue& v, Design& d) {
  const JsonValue modules = v["modules"], patches = v["patches"];
  const Numbers numbers = all_numbers(d.layout);
  for (std::size_t p = 0; p < patches.size(); ++p) {
    const JsonValue patch = patches.at(p);
    const int id = patch["id"].integer(0, kMaxPatch);
    if (id < static_cast<int>(d.patches.size())) patch["id"].fail("must be above that of the patch before it");
    d.patches.resize(static_cast<std::size_t>(id));  // gaps
    d.patches.push_back(read_patch(patch, id, modules, numbers));
    if (d.patches.back().is_gap()) patch["modules"].fail("must name at least one module");
  }
  const std::vector<ModuleWiring> wiring = wiring_of(d);
  for (std::size_t k = 0; k < modules.size(); ++k) require_derived(modules.at(k), d, static_cast<int>(k), wiring[k]);
}

void read_refused(const JsonValue& v, ModuleLayout& layout) {
  if (!v.raw().is_object()) v.fail("must be an object");
  for (const auto& [limit, count] : v.raw().items())
    layout.refused.emplace_back(limit, v[limit.c_str()].integer(0, kMaxCount));
}

}  // namespace

Design parse_design(const std::string& text, const std::string& file) {
  if (text.find_first_not_of(" \t\r\n") == std::string::npos)
    throw InputError(fmt::format("{}: the file is empty", file));
  if (!begins_as_json_object(text)) {
    const std::string what = not_asked_for(text, FileUse::kDesign, file);
    throw InputError(fmt::format("{}: is {}", file,
                                 what.empty() ? "no design file (JSON); triskin design makes one of a mesh" : what));
  }
  const nlohmann::json document = parse_json(text, file);
  // A glTF and a GeoJSON are JSON too.
  if (!document.contains("format")) {
    const std::optional<FileKind> kind = file_kind(text);
    const std::string what = kind && kind->use == FileUse::kOther ? "" : not_asked_for(text, FileUse::kDesign);
    if (!what.empty()) throw InputError(fmt::format("{}: is {}", file, what));
  }
  const JsonValue v(document, file);
  check_head(v);
  Design d;
  d.name = v["name"].text();
  d.design_id = hex64(v["design_id"]);
  d.seed = v["seed"].unsigned_integer();
  read_source(v["source"], d);
  d.surface = read_mesh_json(v["surface"]);
  if (has(v, "side")) d.side = read_side(v["side"]);
  read_limits(v["limits"], d.limits);
  d.pieces = list(v["pieces"], [&](const JsonValue& p) { return read_piece(p, d.surface.faces.size()); });
  read_layout(v, d);
  read_wiring(v, d);
  read_refused(v["refused"], d.layout);
  d.report = read_report(v["report"]);
  read_alternatives(v, d);
  read_regions(v, d);
  return d;
}

Design read_design(const std::filesystem::path& path) {
  return parse_design(read_text(path), path.string());
}

Design read_intact_design(const std::filesystem::path& path) {
  Design design = read_design(path);
  const std::uint64_t own = design_id_of(design);
  if (own != design.design_id) {
    throw InputError(
        fmt::format("{}: design_id is {:016x}, but its modules and wiring give {:016x}: the file was changed after it "
                    "was made; run triskin check on it, and make the design again",
                    path.string(), design.design_id, own));
  }
  return design;
}

}  // namespace triskin::design
