// SPDX-License-Identifier: GPL-3.0-or-later
#include "triskin/placement/polygon_io.hpp"

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <nlohmann/json.hpp>
#include <numeric>

#include "outline.hpp"
#include "polygon_rules.hpp"
#include "triskin/base/error.hpp"
#include "triskin/base/file_kind.hpp"
#include "triskin/base/text_file.hpp"
#include "triskin/design/json_value.hpp"
#include "triskin/geometry/segment.hpp"

namespace triskin::placement {
namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using nlohmann::json;
constexpr double kLargestCoordinate_mm = 1e8;
constexpr double kTouching_mm = 1e-9;  // This is far below every tolerance.

std::string ring_name(std::size_t ring) {
  return ring == 0 ? "outer ring" : fmt::format("hole {}", ring - 1);
}

[[noreturn]] void fail(const std::string& name, const std::string& what) {
  throw InputError(name + ": " + what);
}

Vec2 json_point(const json& j, const std::string& name, std::size_t ring, std::size_t vertex) {
  if (!j.is_array() || j.size() < 2 || !j[0].is_number() || !j[1].is_number()) {
    fail(name, fmt::format("{}, vertex {}: must be two numbers (mm)", ring_name(ring), vertex));
  }
  return {j[0].get<double>(), j[1].get<double>()};
}

// GeoJSON closes its rings by repeating the first vertex at the end (RFC 7946, 3.1.6).
void require_closed(const std::vector<Vec2>& ring, const std::string& name, std::size_t index) {
  if (ring.size() < 4)
    fail(name, fmt::format("{}: needs at least 3 vertices and the first again at the end, has {}", ring_name(index),
                           ring.size()));
  if (ring.front() != ring.back()) {
    fail(name, fmt::format("{}, vertex {}: the ring is open; repeat its first vertex at the end", ring_name(index),
                           ring.size() - 1));
  }
}

Polygon from_coordinates(const json& rings, const std::string& name) {
  if (!rings.is_array()) fail(name, "\"coordinates\" must be a list of rings");
  if (rings.empty()) fail(name, "the polygon is empty: it has no rings");
  Polygon polygon;
  for (std::size_t r = 0; r < rings.size(); ++r) {
    if (!rings[r].is_array()) fail(name, ring_name(r) + ": must be a list of points");
    std::vector<Vec2> ring;
    for (std::size_t v = 0; v < rings[r].size(); ++v) ring.push_back(json_point(rings[r][v], name, r, v));
    require_closed(ring, name, r);
    if (r == 0)
      polygon.outer = std::move(ring);
    else
      polygon.holes.push_back(std::move(ring));
  }
  return polygon;
}

bool are_polygons(const json& list) {
  return std::ranges::all_of(list, [](const json& j) {
    const json& geometry = j.is_object() && j.contains("geometry") ? j["geometry"] : j;
    return geometry.is_object() && geometry.value("type", json()) == "Polygon";
  });
}

Polygon from_geojson(const json& j, const std::string& name) {
  const std::string type =
      j.is_object() && j.contains("type") && j["type"].is_string() ? j["type"].get<std::string>() : "";
  if (type == "Feature" && j.contains("geometry")) {
    if (j["geometry"].is_null()) fail(name, "the feature has no geometry (null)");
    return from_geojson(j["geometry"], name);
  }
  const char* list = type == "FeatureCollection" ? "features" : type == "GeometryCollection" ? "geometries" : nullptr;
  if (list != nullptr) {
    if (!j.contains(list) || !j[list].is_array()) fail(name, fmt::format("\"{}\" must be a list", list));
    if (j[list].size() != 1)
      fail(name,
           fmt::format("holds {} {}, where exactly one polygon is wanted; place each one alone, from a file of its own",
                       j[list].size(), j[list].empty() || !are_polygons(j[list]) ? list : "polygons"));
    return from_geojson(j[list][0], name);
  }
  constexpr std::array<std::string_view, 4> kOthers{"Point", "MultiPoint", "LineString", "MultiLineString"};
  if (std::ranges::find(kOthers, type) != kOthers.end())
    fail(name, fmt::format("holds a {}; a Polygon is needed", type));
  if (type != "Polygon" && type != "MultiPolygon") fail(name, "not a GeoJSON Polygon (\"type\")");
  if (!j.contains("coordinates")) fail(name, "\"coordinates\" is missing");
  const json& coordinates = j["coordinates"];
  if (type == "Polygon") return from_coordinates(coordinates, name);
  if (!coordinates.is_array() || coordinates.size() != 1)
    fail(name, "a MultiPolygon must hold exactly one polygon; place each one alone");
  return from_coordinates(coordinates[0], name);
}

// Reads POLYGON ((x y, x y, …), (…)) of OGC 06-103r4, also with Z and M, both ignored, a MULTIPOLYGON of one, and
// SRID as PostGIS writes it.
class WktReader {
 public:
  WktReader(const std::string& text, const std::string& name) : text_(text), name_(name) {
    constexpr std::string_view kByteOrderMark = "\xEF\xBB\xBF";
    if (text.starts_with(kByteOrderMark)) at_ = kByteOrderMark.size();
  }

  Polygon read() {
    read_srid();
    const std::string type = word();
    const bool is_multi = type.starts_with("MULTIPOLYGON");
    if (!is_multi && !type.starts_with("POLYGON"))
      fail_here("expected POLYGON (WKT), a GeoJSON object, or a drawing in DXF or SVG");
    read_dimension(type.substr(is_multi ? 12 : 7));
    if (is_multi) expect('(');
    Polygon polygon = rings();
    if (is_multi && accept(',')) fail(name_, "a MULTIPOLYGON must hold exactly one polygon; place each one alone");
    if (is_multi) expect(')');
    (void)accept(';');
    skip();
    if (at_ != text_.size()) fail_here("unexpected text after the polygon");
    return polygon;
  }

 private:
  [[noreturn]] void fail_here(const std::string& what) const {
    fail(name_, fmt::format("character {}: {}", at_, what));
  }
  void skip() {
    while (at_ < text_.size() && std::isspace(static_cast<unsigned char>(text_[at_])) != 0) ++at_;
  }
  bool accept(char c) {
    skip();
    if (at_ >= text_.size() || text_[at_] != c) return false;
    ++at_;
    return true;
  }
  void expect(char c) {
    if (!accept(c)) fail_here(fmt::format("expected '{}'", c));
  }
  // Returns the next letters in upper case.
  std::string word() {
    skip();
    std::string word;
    while (at_ < text_.size() && std::isalpha(static_cast<unsigned char>(text_[at_])) != 0)
      word += static_cast<char>(std::toupper(static_cast<unsigned char>(text_[at_++])));
    return word;
  }
  void read_srid() {
    const std::size_t before = at_;
    if (word() != "SRID") {
      at_ = before;
      return;
    }
    const std::size_t end = text_.find(';', at_);
    if (end == std::string::npos) fail_here("expected ';' behind SRID");
    at_ = end + 1;
  }
  // Z, M, ZM or nothing may follow the type with a space or without, then EMPTY.
  void read_dimension(const std::string& dimension) {
    std::string next = dimension.empty() ? word() : dimension;
    if (next == "Z" || next == "M" || next == "ZM") {
      numbers_ = 2 + next.size();
      next = word();
    } else if (!dimension.empty()) {
      fail_here("expected POLYGON (WKT), a GeoJSON object, or a drawing in DXF or SVG");
    }
    if (next == "EMPTY") fail(name_, "the polygon is EMPTY: it has no rings");
    if (!next.empty()) fail_here(fmt::format("\"{}\" is unknown here", next.substr(0, 20)));
  }
  double number() {
    skip();
    double value = 0.0;
    if (at_ < text_.size() && text_[at_] == '+') ++at_;
    const auto [end, error] = std::from_chars(text_.data() + at_, text_.data() + text_.size(), value);
    if (error != std::errc{}) fail_here("expected a number");
    at_ = static_cast<std::size_t>(end - text_.data());
    return value;
  }
  Vec2 point() {
    const double x = number();
    const Vec2 p(x, number());
    std::size_t count = 2;
    for (skip(); at_ < text_.size() && text_[at_] != ',' && text_[at_] != ')'; skip(), ++count) (void)number();
    if (numbers_ == 0) numbers_ = count;  // Older writers omit the letter, so the first point decides.
    if (count != numbers_ || count > 4) fail_here(fmt::format("a point has {} numbers, not {}", count, numbers_));
    return p;
  }
  Polygon rings() {
    Polygon polygon;
    if (const std::size_t before = at_; word() == "EMPTY")
      fail(name_, "the polygon is EMPTY: it has no rings");
    else
      at_ = before;
    expect('(');
    for (std::size_t r = 0; r == 0 || accept(','); ++r) {
      std::vector<Vec2> points;
      expect('(');
      do {
        points.push_back(point());
      } while (accept(','));
      expect(')');
      require_closed(points, name_, r);
      if (r == 0)
        polygon.outer = std::move(points);
      else
        polygon.holes.push_back(std::move(points));
    }
    expect(')');
    return polygon;
  }

  const std::string& text_;
  const std::string& name_;
  std::size_t at_ = 0, numbers_ = 0;
};

void clean_ring(std::vector<Vec2>& ring, const std::string& name, std::size_t index) {
  for (std::size_t v = 0; v < ring.size(); ++v) {
    if (!ring[v].allFinite() || ring[v].cwiseAbs().maxCoeff() > kLargestCoordinate_mm) {
      fail(name, fmt::format(
                     "{}, vertex {} lies at ({:.10g}, {:.10g}); coordinates may be up to 1e8 mm (100 km) from 0. Move "
                     "the outline to the origin, and check that it is in mm",
                     ring_name(index), v, ring[v].x(), ring[v].y()));
    }
  }
  ring.erase(std::unique(ring.begin(), ring.end()), ring.end());
  while (ring.size() > 1 && ring.front() == ring.back()) ring.pop_back();
  if (ring.size() < 3)
    fail(name, fmt::format("{}: needs at least 3 different vertices, has {}", ring_name(index), ring.size()));
}

struct Edge {
  Vec2 a, b;
  std::size_t ring, vertex;
};

CGAL::Orientation side(const Edge& e, const Vec2& p) {
  return CGAL::orientation(Kernel::Point_2(e.a.x(), e.a.y()), Kernel::Point_2(e.b.x(), e.b.y()),
                           Kernel::Point_2(p.x(), p.y()));
}

// A vertex that was put on an edge and then rounded lies beside it by a few units in the last place.
bool touches(const Edge& e, const Vec2& p) {
  const double largest = std::max({e.a.cwiseAbs().maxCoeff(), e.b.cwiseAbs().maxCoeff(), p.cwiseAbs().maxCoeff()});
  return geometry::distance_to_segment(p, e.a, e.b) <= std::max(kTouching_mm, 4.0 * 0x1p-52 * largest);
}

// Returns true if the interiors cross: the ends of each edge lie strictly on both sides of the other. Touching is
// allowed.
bool cross_exactly(const Edge& e, const Edge& f) {
  const auto s1 = side(e, f.a), s2 = side(e, f.b);
  if (s1 == CGAL::COLLINEAR || s1 == s2 || s2 == CGAL::COLLINEAR) return false;
  const auto s3 = side(f, e.a), s4 = side(f, e.b);
  return s3 != CGAL::COLLINEAR && s4 != CGAL::COLLINEAR && s3 != s4;
}

bool cross(const Edge& e, const Edge& f) {
  return cross_exactly(e, f) && !touches(e, f.a) && !touches(e, f.b) && !touches(f, e.a) && !touches(f, e.b);
}

// Returns the first two edges that cross according to `do_cross`.
std::optional<std::pair<Edge, Edge>> find_crossing(const Polygon& polygon, bool (*do_cross)(const Edge&, const Edge&)) {
  std::vector<Edge> edges;
  const auto add = [&](const std::vector<Vec2>& ring, std::size_t index) {
    for (std::size_t v = 0; v < ring.size(); ++v) edges.push_back({ring[v], ring[(v + 1) % ring.size()], index, v});
  };
  add(polygon.outer, 0);
  for (std::size_t h = 0; h < polygon.holes.size(); ++h) add(polygon.holes[h], h + 1);
  std::ranges::sort(edges, {}, [](const Edge& e) { return std::min(e.a.x(), e.b.x()); });
  for (std::size_t i = 0; i < edges.size(); ++i) {
    const double right = std::max(edges[i].a.x(), edges[i].b.x());
    for (std::size_t k = i + 1; k < edges.size() && std::min(edges[k].a.x(), edges[k].b.x()) <= right; ++k) {
      if (do_cross(edges[i], edges[k])) return std::pair(edges[i], edges[k]);
    }
  }
  return std::nullopt;
}

void require_no_crossing(const Polygon& polygon, const std::string& name) {
  const auto found = find_crossing(polygon, cross);
  if (!found) return;
  const auto& [e, f] = *found;
  fail(name, fmt::format("the edge after vertex {} of the {} crosses the edge after vertex {} of the {}; the outline "
                         "must not intersect itself",
                         e.vertex, ring_name(e.ring), f.vertex, ring_name(f.ring)));
}

bool inside_or_on(const std::vector<Vec2>& ring, const Vec2& p) {
  bool inside = false;
  for (std::size_t k = 0; k < ring.size(); ++k) {
    const Edge e{ring[k], ring[(k + 1) % ring.size()], 0, 0};
    const auto s = side(e, p);
    if (touches(e, p)) return true;
    if ((e.a.y() > p.y()) != (e.b.y() > p.y()) && (s == CGAL::LEFT_TURN) == (e.b.y() > e.a.y())) inside = !inside;
  }
  return inside;
}

std::vector<Vec2> net_ring(const json& ring, const std::string& name, std::size_t piece) {
  std::vector<Vec2> points;
  for (const json& p : ring) {
    if (!p.is_array() || p.size() != 2 || !p[0].is_number() || !p[1].is_number())
      fail(name, fmt::format("piece {}: a vertex must be two numbers (mm)", piece));
    points.emplace_back(p[0].get<double>(), p[1].get<double>());
  }
  return points;
}

// Returns the outlines of a net as unfold writes it (docs/unfolding.md).
std::vector<Polygon> pieces_of_net(const json& net, const std::string& name) {
  const json pieces = net.value("pieces", json());
  if (!pieces.is_array() || pieces.empty()) fail(name, "the net has no pieces");
  std::vector<Polygon> polygons;
  for (std::size_t k = 0; k < pieces.size(); ++k) {
    if (!pieces[k].is_object() || !pieces[k].contains("outline")) fail(name, fmt::format("piece {} has no outline", k));
    Polygon polygon;
    polygon.outer = net_ring(pieces[k]["outline"], name, k);
    for (const json& hole : pieces[k].value("holes", json::array())) polygon.holes.push_back(net_ring(hole, name, k));
    polygons.push_back(normalize_polygon(std::move(polygon), fmt::format("{}, piece {}", name, k)));
  }
  return polygons;
}

Polygon scaled(Polygon polygon, std::optional<double> unit_mm) {
  for (Vec2& p : polygon.outer) p *= unit_mm.value_or(1.0);
  for (auto& hole : polygon.holes)
    for (Vec2& p : hole) p *= unit_mm.value_or(1.0);
  return polygon;
}

// GeoJSON of maps has degrees (RFC 7946, 4). Those of a town or a country are too small for a module and lie farther
// from 0 than they are large; a small outline in mm does so rarely, and no module fits on it anyway.
void require_no_degrees(const Polygon& polygon, const std::string& name) {
  Eigen::AlignedBox2d box;
  for (const Vec2& p : polygon.outer) box.extend(p);
  const Vec2 far = box.min().cwiseAbs().cwiseMax(box.max().cwiseAbs());
  const bool is_on_earth = far.x() <= 180.0 && far.y() <= 90.0;
  const double size = box.sizes().maxCoeff();
  if (box.isEmpty() || !is_on_earth || size >= design::kSide_mm || box.exteriorDistance(Vec2(0.0, 0.0)) <= size) return;
  fail(name,
       fmt::format("its coordinates look like degrees of longitude and latitude ({:g}, {:g}), as maps have them; an "
                   "outline has mm (--unit names another length)",
                   polygon.outer.front().x(), polygon.outer.front().y()));
}

// A net may have cracks of zero width, which its pieces need; a drawn polygon may not.
Polygon valid_polygon(Polygon polygon, const std::string& name) {
  clean_ring(polygon.outer, name, 0);
  for (std::size_t h = 0; h < polygon.holes.size(); ++h) clean_ring(polygon.holes[h], name, h + 1);
  require_valid_polygon(polygon, name);
  return normalize_polygon(std::move(polygon), name);
}

Outlines drawn(Drawing drawing, const std::string& name) {
  return {{valid_polygon(std::move(drawing.polygon), name)}, std::move(drawing.remark)};
}

}  // namespace

double ring_area(const std::vector<Vec2>& ring) {
  if (ring.empty()) return 0.0;
  double twice = 0.0;
  const Vec2& origin = ring.front();  // Offsets of 1e6 mm must not cost digits.
  for (std::size_t k = 0; k < ring.size(); ++k) {
    const Vec2 a = ring[k] - origin, b = ring[(k + 1) % ring.size()] - origin;
    twice += a.x() * b.y() - a.y() * b.x();
  }
  return 0.5 * twice;
}

double polygon_area(const Polygon& polygon) {
  double area = std::abs(ring_area(polygon.outer));
  for (const auto& hole : polygon.holes) area -= std::abs(ring_area(hole));
  return area;
}

bool crosses_itself(const Polygon& polygon) {
  return find_crossing(polygon, cross_exactly).has_value();
}

Polygon normalize_polygon(Polygon polygon, const std::string& name) {
  clean_ring(polygon.outer, name, 0);
  for (std::size_t h = 0; h < polygon.holes.size(); ++h) clean_ring(polygon.holes[h], name, h + 1);
  require_no_crossing(polygon, name);
  if (ring_area(polygon.outer) == 0.0) fail(name, "outer ring: has no area");
  if (ring_area(polygon.outer) < 0.0) std::ranges::reverse(polygon.outer);
  for (std::size_t h = 0; h < polygon.holes.size(); ++h) {
    auto& hole = polygon.holes[h];
    if (ring_area(hole) > 0.0) std::ranges::reverse(hole);
    for (std::size_t v = 0; v < hole.size(); ++v) {
      if (!inside_or_on(polygon.outer, hole[v]))
        fail(name, fmt::format("{}, vertex {}: lies outside the outer ring", ring_name(h + 1), v));
    }
  }
  return polygon;
}

Outlines parse_polygons(const std::string& text, const std::string& name, std::optional<double> unit_mm) {
  const auto first = text.find_first_not_of(" \t\r\n\xEF\xBB\xBF");
  if (first == std::string::npos) fail(name, "the file is empty; give a GeoJSON or WKT polygon in mm, or a net");
  const std::optional<FileKind> kind = file_kind(text);
  if (kind && kind->what == "a DXF drawing") return drawn(outline_of_dxf(text, name, unit_mm), name);
  if (kind && kind->what == "an SVG drawing") return drawn(outline_of_svg(text, name, unit_mm), name);
  const bool is_json = text[first] == '{';
  // JSON that may be meant as a polygon is said to lack what it lacks.
  if (!is_json || !kind || kind->use != FileUse::kOther) {
    const std::string other = not_asked_for(text, FileUse::kOutline, is_json ? "" : name);
    if (!other.empty()) fail(name, "is " + other);
  }
  if (!is_json) return {{valid_polygon(scaled(WktReader(text, name).read(), unit_mm), name)}, {}};
  const json document = design::parse_json(text.substr(first), name);
  if (document.value("format", json()) == "triskin-net") {
    if (unit_mm) fail(name, "is a net, which is in mm; leave --unit out");
    return {pieces_of_net(document, name), {}};
  }
  const Polygon polygon = from_geojson(document, name);
  if (!unit_mm) require_no_degrees(polygon, name);
  return {{valid_polygon(scaled(polygon, unit_mm), name)}, {}};
}

Polygon parse_polygon(const std::string& text, const std::string& name) {
  std::vector<Polygon> polygons = parse_polygons(text, name).polygons;
  if (polygons.size() != 1) fail(name, fmt::format("is a net of {} pieces; choose one with --piece", polygons.size()));
  return std::move(polygons.front());
}

Outlines read_polygons(const std::filesystem::path& path, std::optional<double> unit_mm) {
  return parse_polygons(read_text(path), path.string(), unit_mm);
}

Polygon read_polygon(const std::filesystem::path& path) {
  return parse_polygon(read_text(path), path.string());
}

}  // namespace triskin::placement
