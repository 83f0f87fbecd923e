// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <set>
#include <string_view>
#include <vector>

#include "checked_design.hpp"
#include "json_path.hpp"
#include "triskin/base/error.hpp"
#include "triskin/base/json_cause.hpp"

namespace triskin::check {
namespace {

using nlohmann::json;

using namespace json_path;

std::vector<std::array<int, 3>> faces_of(const Value& v, std::size_t n_vertices) {
  return all(v, [n_vertices](const Value& f) { return three_of(f, index_below(n_vertices)); });
}

// With short sides nearer to the centre than the long ones, corners are no longer cut.
double corner_cut(const Value& v) {
  const double value = number(v);
  if (!(value > 0.0 && value <= 10.0)) v.fail(fmt::format("must be above 0 and at most 10, is {}", value));
  return value;
}

void read_side(const Value& j, CheckedDesign& d) {
  d.side = j.at("taken").text();
  d.is_side_certain = j.at("certain").boolean();
  if (!j.contains("part")) return;
  d.part_vertices = all(j.at("part").at("vertices"), p3);
  d.part_faces = faces_of(j.at("part").at("faces"), d.part_vertices.size());
}

// The file names modules by their numbers. Where they do not ascend, the rule module-number reports it, and of equal
// ones the first is meant; but where a name then leads nowhere, the number is what has to be mended.
class ModuleIndex {
 public:
  explicit ModuleIndex(const Value& modules) {
    int last = -1;
    for (std::size_t k = 0; k < modules.size(); ++k) {
      const Value id = modules.item(k).at("id");
      const int number = integer(id);
      if (number <= last && wrong_number_.empty()) {
        wrong_number_ = fmt::format("{}: module-number: is {}{}; numbers of modules ascend from 0", id.path(), number,
                                    k == 0 ? "" : fmt::format(" after {}", last));
      }
      index_.emplace(number, static_cast<int>(k));
      last = number;
    }
  }
  [[nodiscard]] int of(const Value& v) const { return found(v, ""); }
  [[nodiscard]] int of_or_none(const Value& v) const { return integer(v) == -1 ? -1 : found(v, ", or -1 for none"); }

 private:
  [[nodiscard]] int found(const Value& v, const char* or_none) const {
    const auto at = index_.find(integer(v));
    if (at != index_.end()) return at->second;
    if (!wrong_number_.empty()) throw InputError(wrong_number_);
    v.fail(fmt::format("names module {}, which the design does not have; give the id of one of its modules{}",
                       shown(v.raw()), or_none));
  }

  std::map<int, int> index_;
  std::string wrong_number_;  ///< first place where the numbers do not ascend
};

CheckedDesign::Module read_module(const Value& j, const ModuleIndex& index, bool with_lift) {
  CheckedDesign::Module m{};
  m.number = integer(j.at("id"));
  m.island = integer(j.at("island"));
  m.i = bounded(j.at("i"), -1'000'000, 1'000'000);
  m.j = bounded(j.at("j"), -1'000'000, 1'000'000);
  m.up = j.at("up").boolean();
  m.corner = three_of(j.at("corners"), p3);
  m.neighbour = three_of(j.at("neighbours"), [&](const Value& n) { return index.of_or_none(n); });
  m.beside = m.neighbour;
  m.edge_error = number(j.at("edge_error_mm"));
  m.center_gap = number(j.at("center_gap_mm"));
  m.edge_depth = number(j.at("edge_depth_mm"));
  m.edge_lift = with_lift ? number(j.at("edge_lift_mm")) : 0.0;
  m.penetration = number(j.at("penetration_mm"));
  m.overrun = number(j.at("overrun_mm"));
  m.bend_radius = number(j.at("bend_radius_mm"));
  m.hinge_gap = three_of(j.at("hinge_gap_mm"), [](const Value& v) { return number(v); });
  m.fold = three_of(j.at("fold_rad"), [](const Value& v) { return number(v); });
  m.patch = integer(j.at("patch"));
  m.line = integer(j.at("line"));
  m.address = integer(j.at("address"));
  m.rotation = integer(j.at("rotation"));
  m.parent = index.of_or_none(j.at("parent"));
  m.depth = integer(j.at("depth"));
  const Value taxels = j.at("taxels");
  list_of(taxels, 12);
  for (std::size_t t = 0; t < 12; ++t) {
    const Value taxel = taxels.item(t);
    m.taxel[t] = p3(taxel.at("position"));
    m.taxel_normal[t] = p3(taxel.at("normal"));
  }
  return m;
}

// A place in the list is not the number of a module, so an error names that too.
CheckedDesign::Module read_numbered_module(const Value& j, const ModuleIndex& index, bool with_lift) {
  try {
    return read_module(j, index, with_lift);
  } catch (const InputError& e) {
    const std::string what = e.what();
    throw InputError(what.starts_with(j.path() + '/') ? fmt::format("module {}: {}", integer(j.at("id")), what) : what);
  }
}

CheckedDesign::Piece read_piece(const Value& j, std::size_t n_faces) {
  CheckedDesign::Piece p{};
  p.outline = all(j.at("outline"), p2);
  p.holes = all(j.at("holes"), [](const Value& h) { return all(h, p2); });
  p.faces = all(j.at("faces"), index_below(n_faces));
  p.flat = all(j.at("flat"), [](const Value& t) { return three_of(t, p2); });
  p.max_edge_error = number(j.at("max_edge_error_mm"));
  const Value at = j.at("placement");
  p.x = number(at.at("x_mm"));
  p.y = number(at.at("y_mm"));
  p.theta = number(at.at("theta_rad"));
  p.modules = integer(j.at("modules"));
  p.upper_bound = integer(j.at("upper_bound"));
  p.proved = j.at("proved").boolean();
  if (p.flat.size() != p.faces.size())
    j.fail(fmt::format("has {} flat triangles for {} faces; each face has one", p.flat.size(), p.faces.size()));
  return p;
}

// No rule reads the failures, but flash and the sheet do.
void require_failures(const Value& failures, const ModuleIndex& index) {
  for (std::size_t k = 0; k < failures.size(); ++k) {
    const Value failure = failures.item(k), backup = failure.at("backup");
    (void)index.of(failure.at("module"));
    (void)index.of_or_none(failure.at("other"));
    for (std::size_t child = 0; child < backup.size(); ++child) {
      const Value joint = backup.item(child);
      list_of(joint, 2);
      (void)index.of(joint.item(0));
      (void)index.of_or_none(joint.item(1));
    }
  }
}

CheckedDesign::Patch read_patch(const Value& j, const ModuleIndex& index) {
  CheckedDesign::Patch p{};
  p.node_address = integer(j.at("node_address"));
  p.entry = index.of(j.at("entry"));
  p.second_entry = index.of_or_none(j.at("second_entry"));
  p.second_entry_side = bounded(j.at("second_entry_side"), p.second_entry < 0 ? -1 : 0, p.second_entry < 0 ? -1 : 2);
  p.line_hops = integer(j.at("line_hops"));
  p.max_depth = integer(j.at("max_depth"));
  p.modules = all(j.at("modules"), [&](const Value& m) { return index.of(m); });
  p.cut_joints = all(j.at("cut_joints"), [&](const Value& c) {
    list_of(c, 2);
    return std::array{index.of(c.item(0)), index.of(c.item(1))};
  });
  require_failures(j.at("failures"), index);
  return p;
}

// The list in the file names the numbers of the controllers, which ascend and may have gaps.
std::vector<CheckedDesign::Patch> read_patches(const Value& list, const ModuleIndex& index) {
  constexpr int kMaxNumber = 65'535;
  std::vector<CheckedDesign::Patch> patches;
  for (std::size_t k = 0; k < list.size(); ++k) {
    const Value j = list.item(k);
    const int id = bounded(j.at("id"), static_cast<int>(patches.size()), kMaxNumber);
    while (static_cast<int>(patches.size()) < id) {
      CheckedDesign::Patch gap{};
      gap.entry = gap.second_entry = gap.second_entry_side = -1;
      patches.push_back(std::move(gap));
    }
    patches.push_back(read_patch(j, index));
    if (patches.back().modules.empty()) j.fail("a patch has at least one module");
  }
  return patches;
}

void read_obstacle(const Value& j, CheckedDesign::Region& r) {
  r.kind = CheckedDesign::Region::Kind::kObstacle;
  r.margin = number(j.at("margin_mm"));
  r.above = number(j.at("above_mm"));
  r.below = number(j.at("below_mm"));
  const Value mesh = j.at("mesh");
  r.body_vertices = all(mesh.at("vertices"), p3);
  r.body_faces = faces_of(mesh.at("faces"), r.body_vertices.size());
  if (r.body_faces.empty()) mesh.fail("an obstacle has at least one face");
}

CheckedDesign::Region read_region(const Value& j, std::size_t n_faces) {
  CheckedDesign::Region r{};
  r.name = j.at("name").text();
  if (j.contains("sphere")) {
    r.kind = CheckedDesign::Region::Kind::kSphere;
    r.a = p3(j.at("sphere").at("center_mm"));
    r.radius = number(j.at("sphere").at("radius_mm"));
  } else if (j.contains("box")) {
    r.kind = CheckedDesign::Region::Kind::kBox;
    r.a = p3(j.at("box").at("low_mm"));
    r.b = p3(j.at("box").at("high_mm"));
  } else if (j.contains("obstacle")) {
    read_obstacle(j.at("obstacle"), r);
  } else if (j.contains("border")) {
    r.kind = CheckedDesign::Region::Kind::kBorder;
    r.margin = number(j.at("border").at("margin_mm"));
    r.min_width = number(j.at("border").at("min_width_mm"));
    r.max_width = number(j.at("border").at("max_width_mm"));
  } else {
    r.kind = CheckedDesign::Region::Kind::kFaces;
    r.faces = all(j.at("faces"), index_below(n_faces));
  }
  r.free = j.contains("free") && j.at("free").boolean();
  r.cover = j.contains("cover") && j.at("cover").boolean();
  r.entry = j.contains("entry") && j.at("entry").boolean();
  if (r.cover) r.within = number(j.at("within_mm"));
  return r;
}

void read_regions(const Value& j, CheckedDesign& d) {
  d.regions = all(j.at("regions").at("list"), [&](const Value& r) { return read_region(r, d.faces.size()); });
  const bool limits_entries = std::ranges::any_of(d.regions, &CheckedDesign::Region::entry);
  if (limits_entries) d.entries_elsewhere = all(j.at("report").at("entries_elsewhere"), integer);
  for (std::size_t k = 0; k < d.modules.size(); ++k)
    d.modules[k].keep_out = number(j.at("modules").item(k).at("keep_out_mm"));
}

void read_jumpers(const Value& list, const ModuleIndex& index, CheckedDesign& d) {
  for (std::size_t n = 0; n < list.size(); ++n) {
    const Value j = list.item(n), modules = j.at("modules"), sides = j.at("sides");
    list_of(modules, 2);
    list_of(sides, 2);
    CheckedDesign::Jumper jumper{j.at("kind").text(), {}, {}, number(j.at("length_mm")), number(j.at("fold_rad"))};
    for (std::size_t k = 0; k < 2; ++k) {
      jumper.module[k] = index.of(modules.item(k));
      jumper.side[k] = bounded(sides.item(k), 0, 2);
    }
    for (std::size_t k = 0; k < 2; ++k) {
      int& beside =
          d.modules[static_cast<std::size_t>(jumper.module[k])].beside[static_cast<std::size_t>(jumper.side[k])];
      if (beside < 0) beside = jumper.module[1 - k];  // The rule jumper-side reports an occupied side.
    }
    d.jumpers.push_back(std::move(jumper));
  }
}

void read_kinds(const Value& j, CheckedDesign& d) {
  d.kinds = all(j.at("kinds").at("kinds"), [](const Value& k) {
    return CheckedDesign::Kind{k.at("name").text(), k.at("dielectric").text(), integer(k.at("taxels")),
                               number(k.at("sensitivity_counts_per_kpa"))};
  });
  for (std::size_t m = 0; m < d.modules.size(); ++m) d.modules[m].kind = j.at("modules").item(m).at("kind").text();
}

void read_surface(const Value& j, CheckedDesign& d) {
  d.vertices = all(j.at("vertices"), p3);
  d.faces = faces_of(j.at("faces"), d.vertices.size());
  if (d.faces.empty()) j.fail("a surface has at least one face");
}

CheckedDesign::Limits read_limits(const Value& l, bool with_lift, bool with_jumpers) {
  constexpr double kNone = std::numeric_limits<double>::infinity();
  return {number(l.at("edge_error_mm")),
          number(l.at("hinge_gap_mm")),
          number(l.at("center_gap_mm")),
          number(l.at("fold_rad")),
          number(l.at("penetration_mm")),
          number(l.at("overrun_mm")),
          with_lift ? number(l.at("lift_mm")) : kNone,
          with_lift ? number(l.at("depth_mm")) : kNone,
          with_jumpers ? number(l.at("jumper_mm")) : 0.0,
          l.contains("fold_away_rad") ? number(l.at("fold_away_rad")) : kNone,
          l.contains("fold_towards_rad") ? number(l.at("fold_towards_rad")) : kNone};
}

void read_report(const Value& r, CheckedDesign& d) {
  d.area_cm2 = number(r.at("area_cm2"));
  d.coverage = number(r.at("coverage"));
  d.coverage_cut = d.corner_cut > 0.0 ? number(r.at("coverage_cut")) : d.coverage;
  d.upper_bound = integer(r.at("upper_bound"));
  d.patches_lower_bound = integer(r.at("patches_lower_bound"));
  d.max_edge_error = number(r.at("max_edge_error_mm"));
  d.max_hinge_gap = number(r.at("max_hinge_gap_mm"));
  d.max_center_gap = number(r.at("max_center_gap_mm"));
}

void read_side_maxima(const Value& r, CheckedDesign& d) {
  d.max_edge_lift = number(r.at("max_edge_lift_mm"));
  d.max_edge_depth = number(r.at("max_edge_depth_mm"));
}

CheckedDesign read_all(const Value& j) {
  CheckedDesign d{};
  const bool with_jumpers = j.contains("jumpers");
  if (j.at("format").raw() != "triskin-design" || integer(j.at("version")) != (with_jumpers ? 2 : 1))
    throw InputError("not a design file of version 1, or 2 with jumpers; make the design again");
  read_surface(j.at("surface"), d);
  if (j.contains("side")) read_side(j.at("side"), d);
  const Value l = j.at("limits");
  // A file has both keys, or is older than them.
  const bool with_lift = l.contains("lift_mm") || l.contains("depth_mm");
  d.limits = read_limits(l, with_lift, with_jumpers);
  if (j.contains("corner_cut_mm")) d.corner_cut = corner_cut(j.at("corner_cut_mm"));
  d.islands = integer(j.at("islands"));
  d.method = j.at("method").text();
  d.design_id = hex_id(j.at("design_id"));
  const ModuleIndex index(j.at("modules"));
  d.modules = all(j.at("modules"), [&](const Value& m) { return read_numbered_module(m, index, with_lift); });
  d.next_module = j.contains("next_module") ? bounded(j.at("next_module"), 0, 65'536) : -1;
  if (with_jumpers) read_jumpers(j.at("jumpers"), index, d);
  if (j.contains("regions")) read_regions(j, d);
  if (j.contains("kinds")) read_kinds(j, d);
  d.pieces = all(j.at("pieces"), [&](const Value& p) { return read_piece(p, d.faces.size()); });
  d.patches = read_patches(j.at("patches"), index);
  read_report(j.at("report"), d);
  if (with_jumpers) d.jumpers_lower_bound = integer(j.at("report").at("jumpers_lower_bound"));
  if (with_lift) read_side_maxima(j.at("report"), d);
  return d;
}

// Numbers that no rule reads, counts of other layouts, prices and times, are bounded all the same, because the next
// reader of the file may calculate with them. Coordinates have the bound of a coordinate; the radius of a flat place
// has none.
void require_bounded(const json& j, const std::string& key, double bound, const std::string& path) {
  constexpr std::array kCoordinates{"vertices", "faces", "corners",   "position", "outline",
                                    "holes",    "flat",  "placement", "sphere",   "box"};
  constexpr double kMaxOther = 9e6;
  if (j.is_number() && key != "seed" && key != "bend_radius_mm" && !(std::abs(j.get<double>()) <= bound))
    throw InputError(fmt::format("{}: must lie in ±{:g}, is {}", path, bound, shown(j)));
  if (j.is_object()) {
    for (const auto& [name, value] : j.items())
      require_bounded(value, name, std::ranges::count(kCoordinates, name) > 0 ? kMaxNumber : std::min(bound, kMaxOther),
                      path + '/' + name);
  }
  if (j.is_array()) {
    for (std::size_t k = 0; k < j.size(); ++k) require_bounded(j[k], key, bound, path + '/' + std::to_string(k));
  }
}

// A key that no reader knows would change nothing, whatever its author meant by it.
constexpr std::array<std::string_view, 135> kKnownKeys{"above_mm",
                                                       "address",
                                                       "alternatives",
                                                       "area_cm2",
                                                       "backup",
                                                       "below_mm",
                                                       "bend_radius_mm",
                                                       "border",
                                                       "box",
                                                       "center_gap_mm",
                                                       "center_mm",
                                                       "certain",
                                                       "controller",
                                                       "corner_cut_mm",
                                                       "corners",
                                                       "cover",
                                                       "coverage",
                                                       "coverage_cut",
                                                       "cut_joints",
                                                       "depth",
                                                       "depth_mm",
                                                       "design_id",
                                                       "deviation_mm",
                                                       "dielectric",
                                                       "distance_mm",
                                                       "edge_depth_mm",
                                                       "edge_error_mm",
                                                       "edge_lift_mm",
                                                       "elsewhere",
                                                       "entries_elsewhere",
                                                       "entry",
                                                       "face_count",
                                                       "faces",
                                                       "failures",
                                                       "file",
                                                       "flat",
                                                       "fold_away_rad",
                                                       "fold_rad",
                                                       "fold_towards_rad",
                                                       "format",
                                                       "free",
                                                       "high_mm",
                                                       "hinge_gap_mm",
                                                       "holes",
                                                       "i",
                                                       "id",
                                                       "island",
                                                       "islands",
                                                       "j",
                                                       "jumper",
                                                       "jumper_mm",
                                                       "jumpers",
                                                       "jumpers_lower_bound",
                                                       "keep_out_mm",
                                                       "kind",
                                                       "kinds",
                                                       "length_mm",
                                                       "lift_mm",
                                                       "limits",
                                                       "line",
                                                       "line_hops",
                                                       "list",
                                                       "lost_one_entry",
                                                       "lost_rerouted",
                                                       "lost_strapped",
                                                       "low_mm",
                                                       "margin_mm",
                                                       "max_center_gap_mm",
                                                       "max_depth",
                                                       "max_edge_depth_mm",
                                                       "max_edge_error_mm",
                                                       "max_edge_lift_mm",
                                                       "max_hinge_gap_mm",
                                                       "max_width_mm",
                                                       "mesh",
                                                       "method",
                                                       "min_width_mm",
                                                       "module",
                                                       "modules",
                                                       "name",
                                                       "neighbours",
                                                       "next_module",
                                                       "node_address",
                                                       "normal",
                                                       "obstacle",
                                                       "other",
                                                       "outline",
                                                       "overrun_mm",
                                                       "parent",
                                                       "part",
                                                       "patch",
                                                       "patches",
                                                       "patches_lower_bound",
                                                       "penetration_mm",
                                                       "pieces",
                                                       "place_mm",
                                                       "placement",
                                                       "places",
                                                       "position",
                                                       "price",
                                                       "proved",
                                                       "radius_mm",
                                                       "refused",
                                                       "region",
                                                       "regions",
                                                       "report",
                                                       "rms_edge_error_mm",
                                                       "rotation",
                                                       "scale_to_mm",
                                                       "second_entry",
                                                       "second_entry_side",
                                                       "seconds",
                                                       "seed",
                                                       "sensitivity_counts_per_kpa",
                                                       "share",
                                                       "side",
                                                       "sides",
                                                       "source",
                                                       "sphere",
                                                       "surface",
                                                       "taken",
                                                       "taxels",
                                                       "theta_rad",
                                                       "uncovered",
                                                       "up",
                                                       "upper_bound",
                                                       "version",
                                                       "vertices",
                                                       "wall_mm",
                                                       "weight",
                                                       "why",
                                                       "within_mm",
                                                       "worth",
                                                       "x_mm",
                                                       "y_mm"};

// Skips "selection", which is what the user chose of a CAD part, and "refused", whose keys are names of limits.
void require_known_keys(const json& j, const std::string& path) {
  if (j.is_object()) {
    for (const auto& [key, value] : j.items()) {
      if (key == "selection" || key == "refused") continue;
      if (std::ranges::count(kKnownKeys, key) == 0)
        throw InputError(fmt::format("{}: key \"{}\" is unknown in a design file; leave it out", place(path), key));
      require_known_keys(value, path + '/' + key);
    }
  }
  if (j.is_array() && !j.empty() && !j[0].is_number()) {
    for (std::size_t k = 0; k < j.size(); ++k) require_known_keys(j[k], path + '/' + std::to_string(k));
  }
}

// The JSON parser recurses; a design nests 6 deep.
void require_shallow(const std::string& text, const std::string& file) {
  int depth = 0;
  for (const char c : text) {
    depth += c == '[' || c == '{' ? 1 : c == ']' || c == '}' ? -1 : 0;
    if (depth > 1000) throw InputError(fmt::format("{}: nested too deeply; not a design file", file));
  }
}

// The JSON library would silently drop one of two equal keys in an object, so they are an error here.
json parse_once(const std::string& text) {
  std::vector<std::set<std::string>> open;
  return json::parse(text, [&](int, json::parse_event_t event, json& value) {
    if (event == json::parse_event_t::object_start) open.emplace_back();
    if (event == json::parse_event_t::object_end) open.pop_back();
    if (event == json::parse_event_t::key && !open.back().insert(value.get<std::string>()).second)
      throw InputError(fmt::format("key \"{}\" stands twice in one object; leave one out", value.get<std::string>()));
    return true;
  });
}

}  // namespace

CheckedDesign read_checked_design(const std::string& text, const std::string& name) {
  if (!begins_as_json_object(text))
    throw InputError(fmt::format("{}: is no design file (JSON); triskin design makes one of a mesh", name));
  require_shallow(text, name);
  try {
    const json document = parse_once(text);
    require_bounded(document, "", kMaxNumber, "");
    CheckedDesign design = read_all({document, ""});
    require_known_keys(document, "");
    return design;
  } catch (const json::exception& e) {
    throw InputError(fmt::format("{}: not a design file of this version ({}); make it again with triskin design", name,
                                 json_cause(e.what())));
  } catch (const InputError& e) {
    throw InputError(fmt::format("{}: {}", name, e.what()));
  }
}

}  // namespace triskin::check
