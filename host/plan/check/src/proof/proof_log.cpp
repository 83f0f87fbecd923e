// SPDX-License-Identifier: GPL-3.0-or-later
#include "proof_log.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <nlohmann/json.hpp>
#include <set>
#include <string_view>

#include "triskin/base/error.hpp"
#include "triskin/base/json_cause.hpp"

namespace triskin::check {
namespace {

using nlohmann::json;

[[noreturn]] void fail(const std::string& name, const std::string& what) {
  throw InputError(name + ": " + what);
}

const json& member(const json& object, const char* key, const std::string& name) {
  if (!object.is_object() || !object.contains(key)) fail(name, fmt::format("\"{}\" is missing", key));
  return object[key];
}

double number(const json& value, const char* what, const std::string& name) {
  if (!value.is_number() || !std::isfinite(value.get<double>()))
    fail(name, fmt::format("{}: must be a finite number", what));
  return value.get<double>();
}

int count(const json& value, const char* what, const std::string& name) {
  if (!value.is_number_integer() || value.get<std::int64_t>() < 0 || value.get<std::int64_t>() > 100'000'000) {
    fail(name, fmt::format("{}: must be a whole number from 0 on", what));
  }
  return value.get<int>();
}

bool is_tile_index(const json& value) {
  constexpr std::int64_t kMax = 100'000'000;
  return value.is_number_integer() && value >= -kMax && value <= kMax;
}

const json& list(const json& value, const char* what, const std::string& name) {
  if (!value.is_array()) fail(name, fmt::format("{}: must be a list", what));
  return value;
}

std::vector<Ring> json_rings(const json& rings, const std::string& name) {
  std::vector<Ring> result;
  for (const json& points : list(rings, "rings", name)) {
    Ring ring;
    for (const json& p : list(points, "ring", name)) {
      if (!p.is_array() || p.size() < 2) fail(name, "a point must be two numbers");
      ring.push_back({number(p[0], "x", name), number(p[1], "y", name)});
    }
    result.push_back(std::move(ring));
  }
  if (result.empty()) fail(name, "has no ring");
  return result;
}

// Finds the polygon inside features and collections of one.
const json& find_polygon(const json& value, const std::string& name) {
  const std::string type =
      value.is_object() && value.contains("type") && value["type"].is_string() ? value["type"].get<std::string>() : "";
  if (type == "Polygon") return member(value, "coordinates", name);
  if (type == "Feature") return find_polygon(member(value, "geometry", name), name);
  const char* inner = type == "FeatureCollection"    ? "features"
                      : type == "GeometryCollection" ? "geometries"
                      : type == "MultiPolygon"       ? "coordinates"
                                                     : nullptr;
  if (inner == nullptr) fail(name, "not a GeoJSON polygon");
  const json& parts = list(member(value, inner, name), inner, name);
  if (parts.size() != 1) fail(name, "must hold exactly one polygon");
  return type == "MultiPolygon" ? parts[0] : find_polygon(parts[0], name);
}

// Returns the type before the parentheses, in capitals and without spaces, SRID and byte order mark.
std::string wkt_type(std::string_view text) {
  if (const auto srid = text.find(';'); srid != std::string_view::npos && srid < text.find('('))
    text.remove_prefix(srid + 1);
  std::string type;
  for (const char c : text.substr(0, text.find('('))) {
    if (std::isalpha(static_cast<unsigned char>(c)) != 0) type += static_cast<char>(std::toupper(c));
  }
  return type;
}

// Returns the numbers per point as the letters of the type say; 0 allows two to four.
std::size_t wkt_numbers(const std::string& type, const std::string& name) {
  const std::string letters = type.substr(type.starts_with("MULTI") ? 12 : 7);
  if (letters.empty()) return 0;
  if (letters != "Z" && letters != "M" && letters != "ZM") fail(name, "not a WKT polygon");
  return 2 + letters.size();
}

// Reads POLYGON ((x y, …), (…)): numbers between parentheses, commas between points. A MULTIPOLYGON has one more
// pair of parentheses.
std::vector<Ring> wkt_rings(const std::string& text, const std::string& name) {
  const std::string type = wkt_type(text);
  if (!type.starts_with("POLYGON") && !type.starts_with("MULTIPOLYGON")) fail(name, "not a WKT polygon");
  const int ring_depth = type.starts_with("MULTI") ? 3 : 2;
  std::size_t expected = wkt_numbers(type, name);
  std::vector<Ring> rings;
  int depth = 0, polygons = 0;
  std::vector<double> numbers;
  const auto end_point = [&] {
    if (expected == 0) expected = numbers.size();
    if (numbers.size() != expected || expected < 2 || expected > 4)
      fail(name, "a WKT point has another number of numbers");
    rings.back().push_back({numbers[0], numbers[1]});
    numbers.clear();
  };
  for (const char* at = text.c_str() + text.find('('); *at != '\0';) {
    if (*at == '(') {
      if (++depth == ring_depth) rings.emplace_back();
      if (depth == ring_depth - 1 && ++polygons > 1) fail(name, "must hold exactly one polygon");
      ++at;
    } else if (*at == ')' || (*at == ',' && depth == ring_depth)) {
      if (depth == ring_depth) end_point();
      if (*at == ')') --depth;
      ++at;
    } else if (std::isspace(static_cast<unsigned char>(*at)) != 0 || *at == ',' || (*at == ';' && depth == 0)) {
      ++at;
    } else {
      constexpr std::string_view kDecimal = "+-.0123456789eE";
      char* end = nullptr;
      numbers.push_back(std::strtod(at, &end));
      const bool is_decimal = std::all_of(static_cast<const char*>(at), static_cast<const char*>(end),
                                          [&](char c) { return kDecimal.contains(c); });
      if (end == at || !is_decimal || depth != ring_depth || !std::isfinite(numbers.back()))
        fail(name, "not a WKT polygon");
      at = end;
    }
  }
  if (depth != 0 || rings.empty()) fail(name, "not a WKT polygon");
  return rings;
}

// Refuses a key that occurs twice in an object, because one of the two would be dropped silently.
json parse(const std::string& text, const std::string& name) {
  std::vector<std::set<std::string>> open;
  const auto once = [&](int, json::parse_event_t event, json& value) {
    if (event == json::parse_event_t::object_start) open.emplace_back();
    if (event == json::parse_event_t::object_end) open.pop_back();
    if (event == json::parse_event_t::key && !open.back().insert(value.get<std::string>()).second)
      fail(name, fmt::format("the key \"{}\" stands twice in one object", value.get<std::string>()));
    return true;
  };
  try {
    return json::parse(text, once);
  } catch (const json::exception& e) {
    fail(name, fmt::format("not JSON ({})", json_cause(e.what())));
  }
}

ProofBox box_of(const json& c, const std::string& name) {
  if (!c.is_array() || c.size() != 6) fail(name, "a cell must be [x0, x1, y0, y1, theta0, theta1]");
  ProofBox box;
  for (std::size_t k = 0; k < 3; ++k) {
    box.low[k] = number(c[2 * k], "cell", name);
    box.high[k] = number(c[2 * k + 1], "cell", name);
  }
  return box;
}

// Takes the cells out one by one, because a document of all of them would be ten times as long as the log.
json parse_log(const std::string& text, const std::string& name, std::vector<ProofBox>& cells) {
  bool in_cells = false;
  const auto take = [&](int depth, json::parse_event_t event, json& parsed) {
    if (depth == 1 && event == json::parse_event_t::key) in_cells = parsed == "cells";
    const bool element =
        depth == 2 && (event == json::parse_event_t::array_end || event == json::parse_event_t::value ||
                       event == json::parse_event_t::object_end);
    if (!in_cells || !element) return true;
    cells.push_back(box_of(parsed, name));
    return false;
  };
  try {
    return json::parse(text, take);
  } catch (const json::exception& e) {
    fail(name, fmt::format("not JSON ({})", json_cause(e.what())));
  }
}

}  // namespace

std::vector<Ring> read_rings(const std::string& text, const std::string& name) {
  const auto first = text.find_first_not_of(" \t\r\n\xEF\xBB\xBF");
  if (first == std::string::npos) fail(name, "the file is empty");
  if (text[first] == '{') return json_rings(find_polygon(parse(text.substr(first), name), name), name);
  if (text.find('(') == std::string::npos) fail(name, "neither GeoJSON nor WKT");
  return wkt_rings(text, name);
}

ProofLog read_proof_log(const std::string& text, const std::string& name) {
  ProofLog log;
  const json j = parse_log(text, name, log.cells);
  if (member(j, "format", name) != "triskin-placement-proof") fail(name, "not a placement proof (\"format\")");
  if (member(j, "version", name) != 1) fail(name, "unknown version of the proof format");
  log.rings = json_rings(member(j, "rings", name), name);
  const json& pivot = list(member(j, "pivot", name), "pivot", name);
  const json& motion = list(member(j, "motion", name), "motion", name);
  if (pivot.size() != 2 || motion.size() != 3) fail(name, "\"pivot\" must be two numbers, \"motion\" three");
  log.pivot = {number(pivot[0], "pivot", name), number(pivot[1], "pivot", name)};
  for (std::size_t k = 0; k < 3; ++k) log.motion[k] = number(motion[k], "motion", name);
  if (j.contains("shape")) {
    if (!j["shape"].is_string()) fail(name, "\"shape\" must be a name");
    log.shape = kProofShapeNames.value(j["shape"].get<std::string>());
  }
  log.pitch_mm = number(member(j, "pitch_mm", name), "pitch_mm", name);
  if (j.contains("corner_cut_mm")) log.corner_cut_mm = number(j["corner_cut_mm"], "corner_cut_mm", name);
  log.tolerance_mm = number(member(j, "tolerance_mm", name), "tolerance_mm", name);
  log.modules = count(member(j, "modules", name), "modules", name);
  log.upper_bound = count(member(j, "upper_bound", name), "upper_bound", name);
  for (const json& t : list(member(j, "tiles", name), "tiles", name)) {
    if (!t.is_array() || t.size() != 3 || !std::ranges::all_of(t, is_tile_index))
      fail(name, "a tile must be [i, j, up], whole numbers within ±1e8");
    log.tiles.push_back({t[0].get<int>(), t[1].get<int>(), t[2].get<int>() != 0});
  }
  (void)list(member(j, "cells", name), "cells", name);
  return log;
}

std::vector<std::array<PlanePoint, 2>> edge_set(const std::vector<Ring>& rings) {
  std::vector<std::array<PlanePoint, 2>> edges;
  for (const Ring& ring : rings) {
    for (std::size_t k = 0; k < ring.size(); ++k) {
      const auto [a, b] = std::minmax(ring[k], ring[(k + 1) % ring.size()]);
      if (a != b) edges.push_back({a, b});
    }
  }
  std::ranges::sort(edges);
  return edges;
}

}  // namespace triskin::check
