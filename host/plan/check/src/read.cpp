// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <limits>
#include <map>
#include <set>
#include <string_view>
#include <vector>

#include "checked_design.hpp"
#include "triskin/base/error.hpp"
#include "triskin/base/json_cause.hpp"

namespace triskin::check {
namespace {

using nlohmann::json;

constexpr int kMaxCount = 10'000'000;

std::string shown(const json& j) {
  return j.dump().substr(0, 40);
}

// A double still resolves 2 µm there, and no micrometre in a design id exceeds 64 bits.
constexpr double kMaxNumber = 1e10;

// JSON converts a number to any requested type, whether it fits or not.
double number(const json& j) {
  if (!j.is_number()) throw InputError(fmt::format("{} must be a number", shown(j)));
  const double value = j.get<double>();
  if (!(std::abs(value) <= kMaxNumber)) throw InputError(fmt::format("{} is outside ±{:g}", shown(j), kMaxNumber));
  return value;
}
int integer(const json& j) {
  if (!j.is_number_integer()) throw InputError(fmt::format("{} must be a whole number", shown(j)));
  const bool fits = j.is_number_unsigned() ? j.get<std::uint64_t>() <= std::uint64_t{kMaxCount}
                                           : j.get<std::int64_t>() >= -std::int64_t{kMaxCount};
  if (!fits) throw InputError(fmt::format("{} is outside ±{}", shown(j), kMaxCount));
  return j.get<int>();
}

// A list of another length is wrong, whatever its beginning is.
const json& list_of(const json& j, std::size_t n) {
  if (!j.is_array() || j.size() != n) throw InputError(fmt::format("{} must be a list of {}", shown(j), n));
  return j;
}

P2 p2(const json& j) {
  list_of(j, 2);
  return {number(j[0]), number(j[1])};
}
P3 p3(const json& j) {
  list_of(j, 3);
  return {number(j[0]), number(j[1]), number(j[2])};
}

template <class Read>
auto all(const json& j, Read read) {
  std::vector<decltype(read(j))> out;
  for (const json& item : j) out.push_back(read(item));
  return out;
}

std::array<int, 3> three_ints(const json& j) {
  list_of(j, 3);
  return {integer(j[0]), integer(j[1]), integer(j[2])};
}
std::array<double, 3> three(const json& j) {
  list_of(j, 3);
  return {number(j[0]), number(j[1]), number(j[2])};
}

int bounded(int value, int low, int high, const char* what) {
  if (value < low || value > high) throw InputError(fmt::format("{} {} is outside {} … {}", what, value, low, high));
  return value;
}

// With short sides nearer to the centre than the long ones, corners are no longer cut.
double corner_cut(double value) {
  if (!(value > 0.0 && value <= 10.0)) throw InputError(fmt::format("corner_cut_mm {} is outside 0 … 10", value));
  return value;
}

void read_side(const json& j, CheckedDesign& d) {
  d.side = j.at("taken").get<std::string>();
  d.is_side_certain = j.at("certain").get<bool>();
  if (!j.contains("part")) return;
  d.part_vertices = all(j.at("part").at("vertices"), p3);
  d.part_faces = all(j.at("part").at("faces"), three_ints);
  for (const auto& f : d.part_faces) {
    for (const int v : f) bounded(v, 0, static_cast<int>(d.part_vertices.size()) - 1, "vertex of the part");
  }
}

// The file names modules by their numbers. Where one number stands twice, the rule module-number reports it, and the
// first of both is meant.
class ModuleIndex {
 public:
  explicit ModuleIndex(const json& modules) {
    for (const json& m : modules) index_.emplace(integer(m.at("id")), next_++);
  }
  [[nodiscard]] int of(const json& number, const char* what) const {
    const auto found = index_.find(integer(number));
    if (found == index_.end()) throw InputError(fmt::format("{} {} is no module of the design", what, shown(number)));
    return found->second;
  }
  [[nodiscard]] int of_or_none(const json& number, const char* what) const {
    return integer(number) == -1 ? -1 : of(number, what);
  }

 private:
  std::map<int, int> index_;
  int next_ = 0;
};

CheckedDesign::Module read_module(const json& j, const ModuleIndex& index, bool with_lift) {
  CheckedDesign::Module m{};
  m.number = integer(j.at("id"));
  m.island = integer(j.at("island"));
  m.i = bounded(integer(j.at("i")), -1'000'000, 1'000'000, "lattice coordinate");
  m.j = bounded(integer(j.at("j")), -1'000'000, 1'000'000, "lattice coordinate");
  m.up = j.at("up").get<bool>();
  for (std::size_t k = 0; k < 3; ++k) m.corner[k] = p3(list_of(j.at("corners"), 3)[k]);
  for (std::size_t k = 0; k < 3; ++k) m.neighbour[k] = index.of_or_none(list_of(j.at("neighbours"), 3)[k], "neighbour");
  m.beside = m.neighbour;
  m.edge_error = number(j.at("edge_error_mm"));
  m.center_gap = number(j.at("center_gap_mm"));
  m.edge_depth = number(j.at("edge_depth_mm"));
  m.edge_lift = with_lift ? number(j.at("edge_lift_mm")) : 0.0;
  m.penetration = number(j.at("penetration_mm"));
  m.overrun = number(j.at("overrun_mm"));
  m.bend_radius = number(j.at("bend_radius_mm"));
  m.hinge_gap = three(j.at("hinge_gap_mm"));
  m.fold = three(j.at("fold_rad"));
  m.patch = integer(j.at("patch"));
  m.line = integer(j.at("line"));
  m.address = integer(j.at("address"));
  m.rotation = integer(j.at("rotation"));
  m.parent = index.of_or_none(j.at("parent"), "parent");
  m.depth = integer(j.at("depth"));
  for (std::size_t t = 0; t < 12; ++t) {
    const json& taxel = list_of(j.at("taxels"), 12)[t];
    m.taxel[t] = p3(taxel.at("position"));
    m.taxel_normal[t] = p3(taxel.at("normal"));
  }
  return m;
}

CheckedDesign::Piece read_piece(const json& j, int n_faces) {
  CheckedDesign::Piece p{};
  p.outline = all(j.at("outline"), p2);
  p.holes = all(j.at("holes"), [](const json& h) { return all(h, p2); });
  p.faces = all(j.at("faces"), [&](const json& f) { return bounded(integer(f), 0, n_faces - 1, "face"); });
  p.flat = all(j.at("flat"), [](const json& t) {
    list_of(t, 3);
    return std::array{p2(t[0]), p2(t[1]), p2(t[2])};
  });
  p.max_edge_error = number(j.at("max_edge_error_mm"));
  const json& at = j.at("placement");
  p.x = number(at.at("x_mm"));
  p.y = number(at.at("y_mm"));
  p.theta = number(at.at("theta_rad"));
  p.modules = integer(j.at("modules"));
  p.upper_bound = integer(j.at("upper_bound"));
  p.proved = j.at("proved").get<bool>();
  if (p.flat.size() != p.faces.size()) throw InputError("a piece must have as many flat triangles as faces");
  return p;
}

CheckedDesign::Patch read_patch(const json& j, const ModuleIndex& index) {
  CheckedDesign::Patch p{};
  p.node_address = integer(j.at("node_address"));
  p.entry = index.of(j.at("entry"), "entry");
  p.second_entry = index.of_or_none(j.at("second_entry"), "second_entry");
  p.second_entry_side = bounded(integer(j.at("second_entry_side")), p.second_entry < 0 ? -1 : 0,
                                p.second_entry < 0 ? -1 : 2, "second_entry_side");
  p.line_hops = integer(j.at("line_hops"));
  p.max_depth = integer(j.at("max_depth"));
  p.modules = all(j.at("modules"), [&](const json& m) { return index.of(m, "module of a patch"); });
  p.cut_joints = all(j.at("cut_joints"), [&](const json& c) {
    list_of(c, 2);
    return std::array{index.of(c[0], "cut joint"), index.of(c[1], "cut joint")};
  });
  return p;
}

void read_obstacle(const json& j, CheckedDesign::Region& r) {
  r.kind = CheckedDesign::Region::Kind::kObstacle;
  r.margin = number(j.at("margin_mm"));
  r.above = number(j.at("above_mm"));
  r.below = number(j.at("below_mm"));
  const json& mesh = j.at("mesh");
  r.body_vertices = all(mesh.at("vertices"), p3);
  const int last = static_cast<int>(r.body_vertices.size()) - 1;
  r.body_faces = all(mesh.at("faces"), [last](const json& f) {
    list_of(f, 3);
    const auto corner = [&](std::size_t k) { return bounded(integer(f[k]), 0, last, "corner of an obstacle"); };
    return std::array{corner(0), corner(1), corner(2)};
  });
  if (r.body_faces.empty()) throw InputError("an obstacle has no face");
}

CheckedDesign::Region read_region(const json& j, int n_faces) {
  CheckedDesign::Region r{};
  r.name = j.at("name").get<std::string>();
  if (j.contains("sphere")) {
    r.kind = CheckedDesign::Region::Kind::kSphere;
    r.a = p3(j["sphere"].at("center_mm"));
    r.radius = number(j["sphere"].at("radius_mm"));
  } else if (j.contains("box")) {
    r.kind = CheckedDesign::Region::Kind::kBox;
    r.a = p3(j["box"].at("low_mm"));
    r.b = p3(j["box"].at("high_mm"));
  } else if (j.contains("obstacle")) {
    read_obstacle(j["obstacle"], r);
  } else if (j.contains("border")) {
    r.kind = CheckedDesign::Region::Kind::kBorder;
    r.margin = number(j["border"].at("margin_mm"));
    r.min_width = number(j["border"].at("min_width_mm"));
    r.max_width = number(j["border"].at("max_width_mm"));
  } else {
    r.kind = CheckedDesign::Region::Kind::kFaces;
    r.faces = all(j.at("faces"), [n_faces](const json& f) { return bounded(integer(f), 0, n_faces - 1, "face"); });
  }
  r.free = j.contains("free") && j["free"].get<bool>();
  r.cover = j.contains("cover") && j["cover"].get<bool>();
  r.entry = j.contains("entry") && j["entry"].get<bool>();
  if (r.cover) r.within = number(j.at("within_mm"));
  return r;
}

void read_regions(const json& j, CheckedDesign& d) {
  for (const json& r : j.at("regions").at("list"))
    d.regions.push_back(read_region(r, static_cast<int>(d.faces.size())));
  const bool limits_entries = std::ranges::any_of(d.regions, &CheckedDesign::Region::entry);
  if (limits_entries) d.entries_elsewhere = all(j.at("report").at("entries_elsewhere"), integer);
  for (std::size_t k = 0; k < d.modules.size(); ++k)
    d.modules[k].keep_out = number(j.at("modules").at(k).at("keep_out_mm"));
}

void read_jumpers(const json& list, const ModuleIndex& index, CheckedDesign& d) {
  for (const json& j : list) {
    CheckedDesign::Jumper jumper{
        j.at("kind").get<std::string>(), {}, {}, number(j.at("length_mm")), number(j.at("fold_rad"))};
    for (std::size_t k = 0; k < 2; ++k) {
      jumper.module[k] = index.of(list_of(j.at("modules"), 2)[k], "module of a jumper");
      jumper.side[k] = bounded(integer(list_of(j.at("sides"), 2)[k]), 0, 2, "side of a jumper");
    }
    for (std::size_t k = 0; k < 2; ++k) {
      int& beside =
          d.modules[static_cast<std::size_t>(jumper.module[k])].beside[static_cast<std::size_t>(jumper.side[k])];
      if (beside < 0) beside = jumper.module[1 - k];  // The rule jumper-side reports an occupied side.
    }
    d.jumpers.push_back(std::move(jumper));
  }
}

void read_kinds(const json& j, CheckedDesign& d) {
  for (const json& k : j.at("kinds").at("kinds")) {
    d.kinds.push_back({k.at("name").get<std::string>(), k.at("dielectric").get<std::string>(), integer(k.at("taxels")),
                       number(k.at("sensitivity_counts_per_kpa"))});
  }
  for (std::size_t m = 0; m < d.modules.size(); ++m)
    d.modules[m].kind = j.at("modules").at(m).at("kind").get<std::string>();
}

std::uint64_t hex_id(const std::string& text) {
  std::uint64_t id = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), id, 16);
  if (error != std::errc{} || end != text.data() + text.size())
    throw InputError(fmt::format("design_id \"{}\" is not 16 hexadecimal digits", text));
  return id;
}

// Names the part of the file in the message of an error.
template <class Read>
void at_place(const char* part, std::size_t index, Read read) {
  try {
    read();
  } catch (const InputError& e) {
    throw InputError(fmt::format("{} {}: {}", part, index, e.what()));
  }
}

void read_surface(const json& j, CheckedDesign& d) {
  d.vertices = all(j.at("vertices"), p3);
  const int n_vertices = static_cast<int>(d.vertices.size());
  d.faces = all(j.at("faces"), three_ints);
  for (const auto& f : d.faces) {
    for (const int v : f) bounded(v, 0, n_vertices - 1, "vertex");
  }
  if (d.faces.empty()) throw InputError("the surface has no faces");
}

CheckedDesign::Limits read_limits(const json& l, bool with_lift, bool with_jumpers) {
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
          l.contains("fold_away_rad") ? number(l["fold_away_rad"]) : kNone,
          l.contains("fold_towards_rad") ? number(l["fold_towards_rad"]) : kNone};
}

void read_report(const json& r, CheckedDesign& d) {
  d.area_cm2 = number(r.at("area_cm2"));
  d.coverage = number(r.at("coverage"));
  d.coverage_cut = d.corner_cut > 0.0 ? number(r.at("coverage_cut")) : d.coverage;
  d.upper_bound = integer(r.at("upper_bound"));
  d.patches_lower_bound = integer(r.at("patches_lower_bound"));
  d.max_edge_error = number(r.at("max_edge_error_mm"));
  d.max_hinge_gap = number(r.at("max_hinge_gap_mm"));
  d.max_center_gap = number(r.at("max_center_gap_mm"));
}

void read_side_maxima(const json& r, CheckedDesign& d) {
  d.max_edge_lift = number(r.at("max_edge_lift_mm"));
  d.max_edge_depth = number(r.at("max_edge_depth_mm"));
}

CheckedDesign read_all(const json& j) {
  CheckedDesign d{};
  const bool with_jumpers = j.contains("jumpers");
  if (j.at("format") != "triskin-design" || integer(j.at("version")) != (with_jumpers ? 2 : 1))
    throw InputError("not a design file of version 1, or 2 with jumpers; make the design again");
  read_surface(j.at("surface"), d);
  if (j.contains("side")) read_side(j.at("side"), d);
  const json& l = j.at("limits");
  // A file has both keys, or is older than them.
  const bool with_lift = l.contains("lift_mm") || l.contains("depth_mm");
  d.limits = read_limits(l, with_lift, with_jumpers);
  if (j.contains("corner_cut_mm")) d.corner_cut = corner_cut(number(j["corner_cut_mm"]));
  d.islands = integer(j.at("islands"));
  d.method = j.at("method").get<std::string>();
  d.design_id = hex_id(j.at("design_id").get<std::string>());
  const ModuleIndex index(j.at("modules"));
  for (const json& m : j.at("modules"))
    at_place("module", d.modules.size(), [&] { d.modules.push_back(read_module(m, index, with_lift)); });
  d.next_module = j.contains("next_module") ? bounded(integer(j["next_module"]), 0, 65'536, "next_module") : -1;
  if (with_jumpers) read_jumpers(j.at("jumpers"), index, d);
  if (j.contains("regions")) read_regions(j, d);
  if (j.contains("kinds")) read_kinds(j, d);
  for (const json& p : j.at("pieces"))
    at_place("piece", d.pieces.size(), [&] { d.pieces.push_back(read_piece(p, static_cast<int>(d.faces.size()))); });
  for (const json& p : j.at("patches"))
    at_place("patch", d.patches.size(), [&] { d.patches.push_back(read_patch(p, index)); });
  read_report(j.at("report"), d);
  if (with_jumpers) d.jumpers_lower_bound = integer(j.at("report").at("jumpers_lower_bound"));
  if (with_lift) read_side_maxima(j.at("report"), d);
  return d;
}

// Numbers that no rule reads, counts of other layouts, prices and times, are bounded all the same, because the next
// reader of the file may calculate with them. Coordinates have the bound of a coordinate; the radius of a flat place
// has none.
void require_bounded(const json& j, const std::string& key, double bound) {
  constexpr std::array kCoordinates{"vertices", "faces", "corners",   "position", "outline",
                                    "holes",    "flat",  "placement", "sphere",   "box"};
  constexpr double kMaxOther = 9e6;
  if (j.is_number() && key != "seed" && key != "bend_radius_mm" && !(std::abs(j.get<double>()) <= bound))
    throw InputError(fmt::format("\"{}\" {} is outside ±{:g}", key, shown(j), bound));
  if (j.is_object()) {
    for (const auto& [name, value] : j.items())
      require_bounded(value, name,
                      std::ranges::count(kCoordinates, name) > 0 ? kMaxNumber : std::min(bound, kMaxOther));
  }
  if (j.is_array()) {
    for (const json& item : j) require_bounded(item, key, bound);
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
void require_known_keys(const json& j) {
  if (j.is_object()) {
    for (const auto& [key, value] : j.items()) {
      if (key == "selection" || key == "refused") continue;
      if (std::ranges::count(kKnownKeys, key) == 0)
        throw InputError(fmt::format("key \"{}\" is unknown in a design file", key));
      require_known_keys(value);
    }
  }
  if (j.is_array() && !j.empty() && !j[0].is_number()) {
    for (const json& item : j) require_known_keys(item);
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
    require_bounded(document, "", kMaxNumber);
    CheckedDesign design = read_all(document);
    require_known_keys(document);
    return design;
  } catch (const json::exception& e) {
    throw InputError(fmt::format("{}: not a design file of this version ({}); make it again with triskin design", name,
                                 json_cause(e.what())));
  } catch (const InputError& e) {
    throw InputError(fmt::format("{}: {}", name, e.what()));
  }
}

}  // namespace triskin::check
