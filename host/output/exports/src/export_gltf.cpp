// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <nlohmann/json.hpp>
#include <ranges>

#include "metres.hpp"
#include "module_names.hpp"
#include "triskin/base/base64.hpp"
#include "triskin/base/error.hpp"
#include "triskin/design/module_number.hpp"
#include "triskin/design/outline.hpp"
#include "triskin/exports/export.hpp"
#include "triskin/layout/module.hpp"

namespace triskin::exports {
namespace {

using nlohmann::json;

// The glTF 2.0 specification defines these numbers.
constexpr int kFloat = 5126, kUnsignedInt = 5125, kArrayBuffer = 34962, kElementArrayBuffer = 34963;

// The file has one binary buffer with its views and accessors; values are little-endian on every computer.
class Buffer {
 public:
  int add_points(const std::vector<design::Vec3>& points) {
    json low = json::array(), high = json::array();
    for (int x = 0; x < 3; ++x) {
      const auto stored =
          points | std::views::transform([x](const design::Vec3& p) { return static_cast<float>(p[x]); });
      low.push_back(std::ranges::min(stored));  // The bounds must be those of the stored values, which are rounded.
      high.push_back(std::ranges::max(stored));
    }
    const std::size_t start = bytes_.size();
    for (const design::Vec3& p : points) {
      for (int x = 0; x < 3; ++x) put(std::bit_cast<std::uint32_t>(static_cast<float>(p[x])));
    }
    return add(start, kArrayBuffer,
               {{"componentType", kFloat},
                {"count", points.size()},
                {"type", "VEC3"},
                {"min", std::move(low)},
                {"max", std::move(high)}});
  }
  int add_indices(const std::vector<std::array<int, 3>>& faces) {
    const std::size_t start = bytes_.size();
    for (const auto& face : faces) {
      for (const int corner : face) put(static_cast<std::uint32_t>(corner));
    }
    return add(start, kElementArrayBuffer,
               {{"componentType", kUnsignedInt}, {"count", 3 * faces.size()}, {"type", "SCALAR"}});
  }
  void write_into(json& gltf) const {
    gltf["buffers"] = {
        {{"byteLength", bytes_.size()}, {"uri", "data:application/octet-stream;base64," + base64(bytes_)}}};
    gltf["bufferViews"] = views_;
    gltf["accessors"] = accessors_;
  }

 private:
  void put(std::uint32_t word) {
    for (int k = 0; k < 4; ++k) bytes_ += static_cast<char>(word >> 8 * k & 0xFF);
  }
  int add(std::size_t start, int target, json accessor) {
    accessor["bufferView"] = views_.size();
    views_.push_back({{"buffer", 0}, {"byteOffset", start}, {"byteLength", bytes_.size() - start}, {"target", target}});
    accessors_.push_back(std::move(accessor));
    return static_cast<int>(accessors_.size()) - 1;
  }

  std::string bytes_;
  json views_ = json::array(), accessors_ = json::array();
};

json material(const char* name, double red, double green, double blue) {
  return {{"name", name},
          {"doubleSided", true},
          {"pbrMetallicRoughness",
           {{"baseColorFactor", {red, green, blue, 1.0}}, {"metallicFactor", 0.0}, {"roughnessFactor", 0.8}}}};
}

json mesh(const char* name, int points, int indices, int look) {
  return {{"name", name},
          {"primitives", {{{"attributes", {{"POSITION", points}}}, {"indices", indices}, {"material", look}}}}};
}

json vector_of(const design::Vec3& v) {
  return json::array({v.x(), v.y(), v.z()});
}

// Adds the outline of a cut module as a flat fan of triangles, in metres and the node frame.
void add_module_shape(json& gltf, Buffer& buffer, double corner_cut_mm) {
  const std::array<design::Vec3, 3> corner_mm{design::Vec3(-design::kSide_mm / 2, -design::kHeight_mm / 3, 0),
                                              design::Vec3(design::kSide_mm / 2, -design::kHeight_mm / 3, 0),
                                              design::Vec3(0, 2 * design::kHeight_mm / 3, 0)};
  const design::Outline outline = design::outline_of(corner_mm, corner_cut_mm);
  std::vector<design::Vec3> points;
  for (const design::Vec3& p : outline.points()) points.emplace_back(p * kMetres_per_mm);
  std::vector<std::array<int, 3>> faces;
  for (int k = 1; k + 1 < static_cast<int>(points.size()); ++k) faces.push_back({0, k, k + 1});
  const int corners = buffer.add_points(points);
  gltf["meshes"].push_back(mesh("module", corners, buffer.add_indices(faces), 1));
}

// Adds a taxel as a flat disc, in metres and the node frame.
void add_taxel_shapes(json& gltf, Buffer& buffer) {
  constexpr int kRim = 12;
  constexpr double kRadius_m = 0.0015;
  std::vector<design::Vec3> points{{0, 0, 0}};
  std::vector<std::array<int, 3>> faces;
  for (int k = 0; k < kRim; ++k) {
    const double angle_rad = 2 * 3.14159265358979323846 * k / kRim;
    points.emplace_back(kRadius_m * std::cos(angle_rad), kRadius_m * std::sin(angle_rad), 0);
    faces.push_back({0, k + 1, (k + 1) % kRim + 1});
  }
  const int disc = buffer.add_points(points), rim = buffer.add_indices(faces);
  gltf["meshes"].push_back(mesh("taxel", disc, rim, 2));
  gltf["meshes"].push_back(mesh("temperature pad", disc, rim, 3));
}

json taxel_node(const design::Vec3& in_module_mm, const design::Design& design, int id, std::size_t taxel) {
  const bool pressure = layout::measures_pressure(taxel);
  // The small offset keeps the taxel visible above its module.
  const design::Vec3 lifted(in_module_mm.x(), in_module_mm.y(), in_module_mm.z() + 0.1);
  json extras = {
      {"module", design::number_of(design, id)}, {"taxel", taxel}, {"measures", pressure ? "pressure" : "temperature"}};
  if (!design.covers.empty()) extras["cover"] = cover_name(design, id);
  return {{"name", fmt::format("{}_taxel_{}", module_name(design, id), taxel)},
          {"mesh", pressure ? 2 : 3},
          {"translation", vector_of(lifted * kMetres_per_mm)},
          {"extras", std::move(extras)}};
}

json module_extras(const design::Design& design, const design::ModuleWiring& wiring, int id) {
  const design::PlacedModule& m = design.layout.modules[static_cast<std::size_t>(id)];
  json extras = {{"module", design::number_of(design, id)},
                 {"island", island_in_cover(design, id, m.island)},
                 {"patch", patch_in_cover(design, id, wiring.patch)},
                 {"neighbours", design::numbers_of(design, m.neighbour)}};
  if (!design.covers.empty()) extras["cover"] = cover_name(design, id);
  if (wiring.patch < 0) return extras;
  const design::RoutedModule& r = wiring.routed;
  extras.update(json{{"node_address", design::node_address_of(design, wiring.patch)},
                     {"line", r.line},
                     {"address", r.address},
                     {"rotation", r.rotation},
                     {"parent", design::number_of(design, r.parent)},
                     {"depth", r.depth}});
  return extras;
}

int push(json& list, json value) {
  list.push_back(std::move(value));
  return static_cast<int>(list.size()) - 1;
}

int add_module(json& nodes, const design::Design& design, const design::ModuleWiring& wiring, int id) {
  const design::PlacedModule& m = design.layout.modules[static_cast<std::size_t>(id)];
  const ModulePose frame = frame_of(m);
  json children = json::array();
  const auto taxels = design::taxels_of(m, wiring.routed.rotation);
  for (std::size_t t = 0; t < taxels.size(); ++t)
    children.push_back(
        push(nodes, taxel_node(frame.axes.transpose() * (taxels[t].position_mm - frame.origin_mm), design, id, t)));
  const Eigen::Quaterniond q(frame.axes);
  return push(nodes, {{"name", module_name(design, id)},
                      {"mesh", 1},
                      {"translation", vector_of(frame.origin_mm * kMetres_per_mm)},
                      {"rotation", {q.x(), q.y(), q.z(), q.w()}},
                      {"children", std::move(children)},
                      {"extras", module_extras(design, wiring, id)}});
}

design::Vec3 middle_of(const design::PlacedModule& m, int side) {
  const auto s = static_cast<std::size_t>(side);
  return (m.corner_mm[s] + m.corner_mm[(s + 1) % 3]) / 2.0;
}

// Adds a jumper as a line between the middles of its two sides, in the mesh frame.
int add_jumper(json& gltf, json& nodes, Buffer& buffer, const design::Design& design, const design::Jumper& j) {
  constexpr int kLines = 1;
  std::vector<design::Vec3> ends;
  for (std::size_t e = 0; e < 2; ++e)
    ends.emplace_back(middle_of(design.layout.modules.at(static_cast<std::size_t>(j.node[e])), j.side[e]) *
                      kMetres_per_mm);
  const std::string name = jumper_node_name(design, j);
  gltf["meshes"].push_back(
      {{"name", name},
       {"primitives", {{{"attributes", {{"POSITION", buffer.add_points(ends)}}}, {"mode", kLines}, {"material", 4}}}}});
  json extras = {{"jumper", design::jumper_name(design, j)},
                 {"kind", design::kJumperKindNames.name(j.kind)},
                 {"modules", design::numbers_of(design, j.node)},
                 {"sides", j.side},
                 {"length_mm", j.length_mm}};
  if (!design.covers.empty()) extras["cover"] = cover_name(design, j.node[0]);
  return push(nodes, {{"name", name}, {"mesh", gltf["meshes"].size() - 1}, {"extras", std::move(extras)}});
}

json add_nodes(json& nodes, const design::Design& design) {
  const auto wiring = design::wiring_of(design);
  json children = json::array({push(nodes, {{"name", "cover"}, {"mesh", 0}})});
  for (std::size_t k = 0; k < design.layout.modules.size(); ++k)
    children.push_back(add_module(nodes, design, wiring[k], static_cast<int>(k)));
  return children;
}

}  // namespace

std::string gltf(const design::Design& design) {
  if (design.surface.faces.empty())
    throw InputError("export: the design has no surface; make it again with triskin design");
  Buffer buffer;
  json file = {{"asset", {{"version", "2.0"}, {"generator", "triskin"}}}, {"meshes", json::array()}};
  std::vector<design::Vec3> cover;
  for (const design::Vec3& v : design.surface.vertices) cover.emplace_back(v * kMetres_per_mm);
  const int points = buffer.add_points(cover), indices = buffer.add_indices(design.surface.faces);
  file["meshes"].push_back(mesh("cover", points, indices, 0));
  add_module_shape(file, buffer, design.layout.corner_cut_mm);
  add_taxel_shapes(file, buffer);
  file["materials"] = {material("cover", 0.5, 0.5, 0.5), material("module", 0.1, 0.35, 0.2),
                       material("taxel", 0.9, 0.75, 0.3), material("temperature pad", 0.4, 0.4, 0.4)};
  if (!design.layout.jumpers.empty()) file["materials"].push_back(material("jumper", 0.88, 0.42, 0.02));
  json nodes = json::array();
  json children = add_nodes(nodes, design);
  for (const design::Jumper& j : design.layout.jumpers) children.push_back(add_jumper(file, nodes, buffer, design, j));
  const int root = push(
      nodes,
      {{"name", design.name},
       {"children", std::move(children)},
       {"extras",
        {{"design_id", fmt::format("{:016x}", design.design_id)}, {"corner_cut_mm", design.layout.corner_cut_mm}}}});
  file["nodes"] = std::move(nodes);
  file["scenes"] = {{{"nodes", {root}}}};
  file["scene"] = 0;
  buffer.write_into(file);
  return file.dump(-1, ' ', true, json::error_handler_t::replace) + "\n";
}

}  // namespace triskin::exports
