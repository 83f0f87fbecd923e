// SPDX-License-Identifier: GPL-3.0-or-later
#include "gltf_reader.hpp"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <set>

#include "gltf_document.hpp"

namespace triskin::mesh {
namespace {

using nlohmann::json;

constexpr int kMaxDepth = 200;
constexpr std::size_t kMaxShown = 1'000'000, kMaxFaces = 50'000'000;
// The glTF standard gives the primitive modes these numbers.
constexpr std::size_t kTriangles = 4, kStrip = 5, kFan = 6;

std::string name_of(const json& j) {
  return j.contains("name") && j["name"].is_string() ? j["name"].get<std::string>() : std::string();
}

class GltfReader {
 public:
  explicit GltfReader(const MeshSource& source) : source_(source), document_(source) {}

  MeshInUnit read() {
    for (const std::size_t node : roots()) take(node, Eigen::Affine3d::Identity(), source_.objects.wanted.empty(), 0);
    if (skinned_ > 0)
      source_.notes.push_back(
          fmt::format("{} meshes of a skeleton are in the pose in which they are stored", skinned_));
    if (flattened_ > 0) source_.notes.push_back(flattened_note(flattened_));
    if (instanced_ > 0) {
      source_.notes.push_back(
          fmt::format("{} nodes are shown more than once by EXT_mesh_gpu_instancing; each was read once", instanced_));
    }
    return {std::move(mesh_), 1000.0};
  }

 private:
  [[nodiscard]] std::vector<std::size_t> indices(const json& object, const char* key) const {
    std::vector<std::size_t> list;
    if (!object.contains(key)) return list;
    if (!object[key].is_array()) document_.fail(fmt::format("\"{}\" must be a list", key));
    for (const json& v : object[key]) {
      if (!v.is_number_unsigned()) document_.fail(fmt::format("\"{}\" must hold whole numbers", key));
      list.push_back(v.get<std::size_t>());
    }
    return list;
  }

  [[nodiscard]] std::vector<std::size_t> roots() const {
    const json& j = document_.root();
    if (j.contains("scenes")) return indices(document_.element("scenes", document_.whole(j, "scene", 0)), "nodes");
    std::set<std::size_t> children;
    const std::size_t n = j.contains("nodes") ? j["nodes"].size() : 0;
    for (std::size_t k = 0; k < n; ++k) {
      for (const std::size_t child : indices(document_.element("nodes", k), "children")) children.insert(child);
    }
    std::vector<std::size_t> roots;
    for (std::size_t k = 0; k < n; ++k) {
      if (!children.contains(k)) roots.push_back(k);
    }
    return roots;
  }

  // A node has either a matrix, or a scale followed by a rotation (quaternion x, y, z, w) and a translation.
  [[nodiscard]] Eigen::Affine3d place_of(const json& node) const {
    Eigen::Affine3d place = Eigen::Affine3d::Identity();
    if (const auto m = document_.numbers(node, "matrix", 16); !m.empty()) {
      for (int k = 0; k < 16; ++k) place.matrix()(k % 4, k / 4) = m[static_cast<std::size_t>(k)];
      return place;
    }
    if (const auto t = document_.numbers(node, "translation", 3); !t.empty()) place.translate(Vec3(t[0], t[1], t[2]));
    if (const auto r = document_.numbers(node, "rotation", 4); !r.empty()) {
      const Eigen::Quaterniond q(r[3], r[0], r[1], r[2]);
      if (!(q.norm() > 0.5)) document_.fail("a rotation of a node is no unit quaternion");
      place.rotate(q.normalized());
    }
    if (const auto s = document_.numbers(node, "scale", 3); !s.empty()) place.scale(Vec3(s[0], s[1], s[2]));
    return place;
  }

  // Returns true if the node or one below it has faces. Nodes below the wanted one belong to it.
  bool take(std::size_t index, const Eigen::Affine3d& parent, bool is_in, int depth) {
    if (depth > kMaxDepth || ++shown_ > kMaxShown) document_.fail("its nodes have no end");
    const json& node = document_.element("nodes", index);
    const Eigen::Affine3d place = parent * place_of(node);
    const std::string name = name_of(node);
    is_in = is_in || (!source_.objects.wanted.empty() && name == source_.objects.wanted);
    bool has_faces = false;
    if (node.contains("mesh")) {
      const json& mesh = document_.element("meshes", document_.whole(node, "mesh"));
      has_faces = true;
      skinned_ += node.contains("skin") ? 1 : 0;
      instanced_ += node.contains("extensions") && node["extensions"].contains("EXT_mesh_gpu_instancing") ? 1 : 0;
      const bool is_named = source_.objects.meets(name_of(mesh));
      if (is_in || is_named) append(mesh, place);
      flattened_ += place.linear().determinant() == 0.0 ? 1 : 0;
    }
    for (const std::size_t child : indices(node, "children"))
      has_faces = take(child, place, is_in, depth + 1) || has_faces;
    if (has_faces) source_.objects.meets(name);
    return has_faces;
  }

  void append(const json& mesh, const Eigen::Affine3d& place) {
    if (!mesh.contains("primitives") || !mesh["primitives"].is_array()) document_.fail("a mesh has no primitives");
    for (const json& primitive : mesh["primitives"]) {
      const std::size_t mode = document_.whole(primitive, "mode", kTriangles);
      if (mode < kTriangles) continue;  // Points and lines carry no surface.
      if (mode > kFan) document_.fail(fmt::format("a primitive has the unknown mode {}", mode));
      append_primitive(primitive, mode, place);
    }
  }

  void append_primitive(const json& primitive, std::size_t mode, const Eigen::Affine3d& place) {
    if (!primitive.contains("attributes") || !primitive["attributes"].contains("POSITION"))
      document_.fail("a primitive has no positions");
    const auto p = document_.accessor(document_.whole(primitive["attributes"], "POSITION"), 3);
    const std::size_t first = mesh_.vertices.size(), count = p.size() / 3;
    for (std::size_t v = 0; v < count; ++v)
      mesh_.vertices.push_back(place * Vec3(p[3 * v], p[3 * v + 1], p[3 * v + 2]));
    std::vector<double> corners;
    if (primitive.contains("indices"))
      corners = document_.accessor(document_.whole(primitive, "indices"), 1);
    else
      for (std::size_t v = 0; v < count; ++v) corners.push_back(static_cast<double>(v));
    if (!std::ranges::all_of(corners, [&](double v) { return v >= 0.0 && v < static_cast<double>(count); }))
      document_.fail("a face names a vertex that does not exist");
    if (mode == kTriangles && corners.size() % 3 != 0) document_.fail("the last triangle of a primitive is not whole");
    append_faces(corners, mode, static_cast<int>(first), place.linear().determinant() < 0.0);
  }

  void append_faces(const std::vector<double>& corners, std::size_t mode, int first, bool is_mirrored) {
    const auto at = [&](std::size_t k) { return first + static_cast<int>(corners[k]); };
    const auto add = [&](std::size_t a, std::size_t b, std::size_t c) {
      mesh_.faces.push_back(is_mirrored ? std::array{at(a), at(c), at(b)} : std::array{at(a), at(b), at(c)});
    };
    const std::size_t step = mode == kTriangles ? 3 : 1;
    for (std::size_t k = 0; k + 2 < corners.size(); k += step) {
      if (mode == kFan)
        add(k + 1, k + 2, 0);
      else if (mode == kStrip && k % 2 == 1)
        add(k, k + 2, k + 1);
      else
        add(k, k + 1, k + 2);
    }
    if (mesh_.faces.size() > kMaxFaces) document_.fail("it is too large");
  }

  const MeshSource& source_;
  GltfDocument document_;
  Mesh mesh_;
  std::size_t shown_ = 0, skinned_ = 0, instanced_ = 0, flattened_ = 0;
};

}  // namespace

MeshInUnit read_gltf(const MeshSource& source) {
  return GltfReader(source).read();
}

}  // namespace triskin::mesh
