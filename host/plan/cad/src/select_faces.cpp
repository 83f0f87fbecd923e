// SPDX-License-Identifier: GPL-3.0-or-later
#include "triskin/cad/select_faces.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <map>
#include <numbers>
#include <set>

#include "triskin/base/error.hpp"
#include "triskin/geometry/triangle.hpp"

namespace triskin::cad {
namespace {

using design::BrepFaceIndex;
using design::Vec3;
using design::VertexIndex;

/// The lower one comes first.
using FacePair = std::pair<BrepFaceIndex, BrepFaceIndex>;

constexpr std::size_t kMaxListed = 10;
// The same display colour differs by rounding between programs.
constexpr int kSameColour = 8;

template <class Value>
bool holds(const std::vector<Value>& values, const Value& value) {
  return std::ranges::find(values, value) != values.end();
}

std::string listed(const std::set<std::string>& names) {
  if (names.empty()) return "none";
  std::vector<std::string> first;
  for (const std::string& name : names) {
    if (first.size() < kMaxListed) first.push_back(name);
  }
  return fmt::format("{}{}", fmt::join(first, ", "), names.size() > kMaxListed ? ", …" : "");
}

std::array<int, 3> colour_value(const std::string& text) {
  static const std::map<std::string, std::string> kNamed{
      {"red", "#ff0000"},     {"green", "#00ff00"}, {"blue", "#0000ff"},  {"yellow", "#ffff00"}, {"cyan", "#00ffff"},
      {"magenta", "#ff00ff"}, {"black", "#000000"}, {"white", "#ffffff"}, {"grey", "#808080"},   {"orange", "#ffa500"}};
  const auto named = kNamed.find(text);
  const std::string hex = named == kNamed.end() ? text : named->second;
  std::array<int, 3> value{-1, -1, -1};
  if (hex.size() != 7 || hex[0] != '#') return value;
  for (std::size_t k = 0; k < 3; ++k) {
    const char* from = hex.data() + 1 + 2 * k;
    if (std::from_chars(from, from + 2, value[k], 16).ptr != from + 2) return {-1, -1, -1};
  }
  return value;
}

bool is_same_colour(const std::string& a, const std::string& b) {
  const auto x = colour_value(a), y = colour_value(b);
  return std::abs(x[0] - y[0]) <= kSameColour && std::abs(x[1] - y[1]) <= kSameColour &&
         std::abs(x[2] - y[2]) <= kSameColour;
}

bool is_body(const Part& part, int body, const std::string& wanted) {
  const Body& b = part.bodies[static_cast<std::size_t>(body)];
  return b.name == wanted || b.path == wanted || std::to_string(body) == wanted;
}

BrepFaceIndex nearest_face(const Part& part, const Vec3& point) {
  double nearest = 1e300;
  BrepFaceIndex face = BrepFaceIndex::none();
  for (std::size_t t = 0; t < part.mesh.faces.size(); ++t) {
    const auto corner = [&](std::size_t k) {
      return part.mesh.vertices[static_cast<std::size_t>(part.mesh.faces[t][k])];
    };
    const double distance = geometry::distance_to_triangle(point, {corner(0), corner(1), corner(2)});
    if (distance < nearest) nearest = distance, face = part.face_of_triangle[t];
  }
  return face;
}

// Returns pairs of faces whose common sides all turn less than the limit.
std::vector<FacePair> smooth_neighbours(const Part& part, double smooth_deg) {
  std::map<std::pair<VertexIndex, VertexIndex>, std::size_t> first_side;
  std::map<FacePair, double> sharpest;  // Two faces have the least cosine between their normals.
  const auto normal = [&](std::size_t t) {
    const auto& f = part.mesh.faces[t];
    const auto at = [&](std::size_t k) { return part.mesh.vertices[static_cast<std::size_t>(f[k])]; };
    return (at(1) - at(0)).cross(at(2) - at(0)).normalized();
  };
  for (std::size_t t = 0; t < part.mesh.faces.size(); ++t) {
    const auto& f = part.mesh.faces[t];
    for (std::size_t k = 0; k < 3; ++k) {
      const auto [other, is_new] = first_side.emplace(std::minmax({VertexIndex(f[k]), VertexIndex(f[(k + 1) % 3])}), t);
      const BrepFaceIndex a = part.face_of_triangle[t], b = part.face_of_triangle[other->second];
      if (is_new || a == b) continue;
      const auto [pair, is_first] = sharpest.emplace(std::minmax(a, b), 1.0);
      pair->second = std::min(pair->second, normal(t).dot(normal(other->second)));
    }
  }
  std::vector<FacePair> smooth;
  const double limit = std::cos(smooth_deg * std::numbers::pi / 180.0);
  for (const auto& [pair, cosine] : sharpest) {
    if (cosine >= limit) smooth.push_back(pair);
  }
  return smooth;
}

std::set<BrepFaceIndex> region_from(const Part& part, const Vec3& point, double smooth_deg) {
  const auto pairs = smooth_neighbours(part, smooth_deg);
  std::set<BrepFaceIndex> region{nearest_face(part, point)};
  for (bool grows = true; grows;) {
    grows = false;
    for (const auto& [a, b] : pairs) {
      if (region.contains(a) == region.contains(b)) continue;
      region.insert({a, b});
      grows = true;
    }
  }
  return region;
}

void require_known(const Part& part, const FaceSelection& s) {
  std::set<std::string> names, colours, bodies;
  for (const Face& f : part.faces) {
    if (!f.name.empty()) names.insert(f.name);
    if (!f.colour.empty()) colours.insert(f.colour);
  }
  for (const Body& b : part.bodies) bodies.insert(b.name);
  for (const BrepFaceIndex i : s.indices) {
    if (i < 0 || static_cast<std::size_t>(i) >= part.faces.size())
      throw InputError(fmt::format("the part has no face {}; it has 0 … {}", i, part.faces.size() - 1));
  }
  for (const std::string& name : s.names) {
    if (!names.contains(name))
      throw InputError(fmt::format("the part has no face named \"{}\"; names: {}", name, listed(names)));
  }
  for (const std::string& colour : s.colours) {
    if (colour_value(colour)[0] < 0)
      throw InputError(fmt::format(
          "\"{}\" is no colour; give #rrggbb or red, green, blue, yellow, cyan, magenta, black, white, grey, orange",
          colour));
    if (std::ranges::none_of(colours, [&](const std::string& c) { return is_same_colour(c, colour); }))
      throw InputError(fmt::format("no face has the colour {}; colours: {}", colour, listed(colours)));
  }
  for (const auto* list : {&s.bodies, &s.without_bodies}) {
    for (const std::string& wanted : *list) {
      bool is_there = false;
      for (std::size_t b = 0; b < part.bodies.size(); ++b)
        is_there = is_there || is_body(part, static_cast<int>(b), wanted);
      if (!is_there) throw InputError(fmt::format("the part has no body \"{}\"; names: {}", wanted, listed(bodies)));
    }
  }
}

bool meets(const Part& part, BrepFaceIndex index, const FaceSelection& s) {
  const Face& f = part.faces[static_cast<std::size_t>(index)];
  const double area_cm2 = f.area_mm2 / 100.0;
  const auto is_in = [&](const std::string& body) { return is_body(part, f.body, body); };
  const bool is_asked_for = !s.indices.empty() || !s.names.empty() || !s.bodies.empty();
  return (!f.is_hidden || is_asked_for) && (s.indices.empty() || holds(s.indices, index)) &&
         (s.names.empty() || holds(s.names, f.name)) && (s.kinds.empty() || holds(s.kinds, f.kind)) &&
         (s.bodies.empty() || std::ranges::any_of(s.bodies, is_in)) &&
         (s.colours.empty() ||
          std::ranges::any_of(s.colours, [&](const std::string& c) { return is_same_colour(f.colour, c); })) &&
         (!s.min_area_cm2 || area_cm2 >= *s.min_area_cm2) && (!s.max_area_cm2 || area_cm2 <= *s.max_area_cm2) &&
         (!s.only_outward || f.side == FaceSide::kOutward) && std::ranges::none_of(s.without_bodies, is_in) &&
         !(f.hole_diameter_mm > 0.0 && f.hole_diameter_mm <= s.without_holes_mm);
}

}  // namespace

bool FaceSelection::is_empty() const {
  return indices.empty() && names.empty() && colours.empty() && kinds.empty() && bodies.empty() && !min_area_cm2 &&
         !max_area_cm2 && !from_point_mm && !only_outward && without_holes_mm <= 0.0 && without_bodies.empty();
}

std::vector<BrepFaceIndex> select_faces(const Part& part, const FaceSelection& selection) {
  require_known(part, selection);
  std::set<BrepFaceIndex> region;
  if (selection.from_point_mm) region = region_from(part, *selection.from_point_mm, selection.smooth_deg);
  std::vector<BrepFaceIndex> chosen;
  for (BrepFaceIndex f{0}; f < static_cast<int>(part.faces.size()); ++f) {
    if (selection.from_point_mm && !region.contains(f)) continue;
    if (meets(part, f, selection)) chosen.push_back(f);
  }
  if (chosen.empty() && std::ranges::all_of(part.faces, &Face::is_hidden))
    throw InputError(
        "no face is left: every body is switched off in the CAD program; switch on there what counts and export again, "
        "or name a body with --object");
  if (chosen.empty()) throw InputError("no face meets all that was asked for; triskin faces lists what the part has");
  return chosen;
}

design::Mesh mesh_of_faces(const Part& part, const std::vector<BrepFaceIndex>& faces) {
  std::vector<bool> is_in(part.faces.size(), false);
  for (const BrepFaceIndex f : faces) is_in.at(static_cast<std::size_t>(f)) = true;
  std::vector<int> vertex(part.mesh.vertices.size(), -1);
  design::Mesh mesh;
  for (std::size_t t = 0; t < part.mesh.faces.size(); ++t) {
    if (!is_in[static_cast<std::size_t>(part.face_of_triangle[t])]) continue;
    std::array<int, 3> corners = part.mesh.faces[t];
    for (int& v : corners) {
      int& own = vertex[static_cast<std::size_t>(v)];
      if (own < 0) {
        own = static_cast<int>(mesh.vertices.size());
        mesh.vertices.push_back(part.mesh.vertices[static_cast<std::size_t>(v)]);
      }
      v = own;
    }
    mesh.faces.push_back(corners);
  }
  return mesh;
}

}  // namespace triskin::cad
