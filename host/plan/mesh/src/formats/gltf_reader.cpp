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
    if (flattened_ > 0) source_.notes.push_back(flattened_note(flattened_));
    if (!hidden_.empty()) source_.notes.push_back(hidden_note(hidden_));
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

  // Returns true if the node or one below it has faces. Nodes below the wanted one belong to it. A node that its author
  // made invisible (KHR_node_visibility) hides those below it; it is read only if it is the wanted one.
  bool take(std::size_t index, const Eigen::Affine3d& parent, bool is_in, int depth) {
    if (depth > kMaxDepth || ++shown_ > kMaxShown) document_.fail("its nodes have no end");
    const json& node = document_.element("nodes", index);
    const Eigen::Affine3d place = parent * place_of(node);
    const std::string name = name_of(node);
    const bool hides = is_in && is_invisible(node);
    is_in = (is_in && !hides) || (!source_.objects.wanted.empty() && name == source_.objects.wanted);
    bool has_faces = false;
    if (node.contains("mesh")) {
      const json& mesh = document_.element("meshes", document_.whole(node, "mesh"));
      has_faces = true;
      const bool is_named = source_.objects.meets(name_of(mesh));
      if (is_in || is_named) append_node(node, mesh, place);
    }
    for (const std::size_t child : indices(node, "children"))
      has_faces = take(child, place, is_in, depth + 1) || has_faces;
    if (has_faces) source_.objects.meets(name);
    if (hides && !is_in && has_faces) hidden_.push_back(name.empty() ? fmt::format("node {}", index) : name);
    return has_faces;
  }

  static bool is_invisible(const json& node) {
    const auto extensions = node.find("extensions");
    if (extensions == node.end() || !extensions->contains("KHR_node_visibility")) return false;
    const json& visibility = (*extensions)["KHR_node_visibility"];
    return visibility.is_object() && visibility.contains("visible") && visibility["visible"] == false;
  }

  // The place of a node with a skin is that of its joints; its own is not applied (glTF 2.0, 3.7.3.3).
  void append_node(const json& node, const json& mesh, const Eigen::Affine3d& place) {
    weights_ = node.contains("weights") ? document_.list(node, "weights") : document_.list(mesh, "weights");
    joints_.clear();
    if (node.contains("skin")) {
      joints_ = joints_of(document_.element("skins", document_.whole(node, "skin")));
      return append(mesh, Eigen::Affine3d::Identity());
    }
    for (const Eigen::Affine3d& instance : instances_of(node)) {
      append(mesh, place * instance);
      flattened_ += (place * instance).linear().determinant() == 0.0 ? 1 : 0;
    }
  }

  // Joints move a point by their place in the scene times their inverse bind matrix, both from the file.
  [[nodiscard]] std::vector<Eigen::Affine3d> joints_of(const json& skin) {
    const std::vector<std::size_t> nodes = indices(skin, "joints");
    if (nodes.empty()) document_.fail("a skin has no joints");
    std::vector<double> inverse;
    if (skin.contains("inverseBindMatrices"))
      inverse = document_.accessor(document_.whole(skin, "inverseBindMatrices"), 16);
    if (!inverse.empty() && inverse.size() < 16 * nodes.size())
      document_.fail("a skin has fewer inverse bind matrices than joints");
    std::vector<Eigen::Affine3d> joints;
    for (std::size_t j = 0; j < nodes.size(); ++j) {
      joints.push_back(place_in_scene(nodes[j]));
      if (inverse.empty()) continue;
      Eigen::Affine3d bind;
      for (int k = 0; k < 16; ++k) bind.matrix()(k % 4, k / 4) = inverse[16 * j + static_cast<std::size_t>(k)];
      joints.back() = joints.back() * bind;
    }
    return joints;
  }
  [[nodiscard]] Eigen::Affine3d place_in_scene(std::size_t index) {
    if (parents_.empty()) {
      const std::size_t n = document_.root().contains("nodes") ? document_.root()["nodes"].size() : 0;
      parents_.assign(n, n);
      for (std::size_t k = 0; k < n; ++k) {
        for (const std::size_t child : indices(document_.element("nodes", k), "children")) {
          if (child < n) parents_[child] = k;
        }
      }
    }
    Eigen::Affine3d place = place_of(document_.element("nodes", index));
    int depth = 0;
    for (std::size_t k = parents_.at(index); k < parents_.size(); k = parents_[k]) {
      if (++depth > kMaxDepth) document_.fail("its nodes have no end");
      place = place_of(document_.element("nodes", k)) * place;
    }
    return place;
  }

  // A node may be shown at several places relative to its own (EXT_mesh_gpu_instancing).
  [[nodiscard]] std::vector<Eigen::Affine3d> instances_of(const json& node) {
    constexpr const char* kInstancing = "EXT_mesh_gpu_instancing";
    if (!node.contains("extensions") || !node["extensions"].contains(kInstancing)) return {Eigen::Affine3d::Identity()};
    const json& instancing = node["extensions"][kInstancing];
    if (!instancing.is_object() || !instancing.contains("attributes"))
      document_.fail(fmt::format("{} has no attributes", kInstancing));
    const json& attributes = instancing["attributes"];
    const auto read = [&](const char* key, std::size_t width) {
      return attributes.contains(key) ? document_.accessor(document_.whole(attributes, key), width)
                                      : std::vector<double>();
    };
    const auto t = read("TRANSLATION", 3), r = read("ROTATION", 4), s = read("SCALE", 3);
    const std::size_t count = std::max({t.size() / 3, r.size() / 4, s.size() / 3});
    if ((!t.empty() && t.size() != 3 * count) || (!r.empty() && r.size() != 4 * count) ||
        (!s.empty() && s.size() != 3 * count))
      document_.fail(fmt::format("the attributes of {} differ in their number", kInstancing));
    std::vector<Eigen::Affine3d> places(count, Eigen::Affine3d::Identity());
    for (std::size_t k = 0; k < count; ++k) {
      if (!t.empty()) places[k].translate(Vec3(t[3 * k], t[3 * k + 1], t[3 * k + 2]));
      if (!r.empty())
        places[k].rotate(Eigen::Quaterniond(r[4 * k + 3], r[4 * k], r[4 * k + 1], r[4 * k + 2]).normalized());
      if (!s.empty()) places[k].scale(Vec3(s[3 * k], s[3 * k + 1], s[3 * k + 2]));
    }
    return places;
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

  // The positions with the default weights of their morph targets (glTF 2.0, 3.7.2.2).
  [[nodiscard]] std::vector<double> positions_of(const json& primitive) {
    std::vector<double> p = document_.accessor(document_.whole(primitive["attributes"], "POSITION"), 3);
    if (!primitive.contains("targets") || !primitive["targets"].is_array()) return p;
    for (std::size_t t = 0; t < std::min(weights_.size(), primitive["targets"].size()); ++t) {
      const json& target = primitive["targets"][t];
      if (weights_[t] == 0.0 || !target.contains("POSITION")) continue;
      const auto moved = document_.accessor(document_.whole(target, "POSITION"), 3);
      if (moved.size() != p.size()) document_.fail("a morph target has another number of vertices than its mesh");
      for (std::size_t k = 0; k < p.size(); ++k) p[k] += weights_[t] * moved[k];
    }
    return p;
  }

  // Each vertex is moved by the weighted mean of its joints.
  [[nodiscard]] std::vector<Eigen::Affine3d> skin_of(const json& attributes, std::size_t count) {
    std::vector<Eigen::Affine3d> places(count);
    for (Eigen::Affine3d& place : places) place.matrix().setZero();
    std::vector<double> sums(count, 0.0);
    for (int set = 0; attributes.contains(fmt::format("JOINTS_{}", set)); ++set) {
      const std::string weights_key = fmt::format("WEIGHTS_{}", set), joints_key = fmt::format("JOINTS_{}", set);
      const auto joints = document_.accessor(document_.whole(attributes, joints_key.c_str()), 4);
      const auto weights = document_.accessor(document_.whole(attributes, weights_key.c_str()), 4);
      if (joints.size() != 4 * count || weights.size() != 4 * count)
        document_.fail("joints and weights of a skin are not as many as its vertices");
      for (std::size_t k = 0; k < joints.size(); ++k) {
        if (weights[k] == 0.0) continue;
        if (!(joints[k] >= 0.0) || joints[k] >= static_cast<double>(joints_.size()))
          document_.fail("a vertex names a joint that its skin lacks");
        places[k / 4].matrix() += weights[k] * joints_[static_cast<std::size_t>(joints[k])].matrix();
        sums[k / 4] += weights[k];
      }
    }
    for (std::size_t v = 0; v < count; ++v) {
      if (!(sums[v] > 0.0)) document_.fail(fmt::format("vertex {} of a skin hangs on no joint", v));
      places[v].matrix() /= sums[v];
    }
    return places;
  }

  void append_primitive(const json& primitive, std::size_t mode, const Eigen::Affine3d& place) {
    if (!primitive.contains("attributes") || !primitive["attributes"].contains("POSITION"))
      document_.fail("a primitive has no positions");
    const auto p = positions_of(primitive);
    const std::size_t first = mesh_.vertices.size(), count = p.size() / 3;
    std::vector<Eigen::Affine3d> places{place};
    if (!joints_.empty() && count > 0) places = skin_of(primitive["attributes"], count);
    for (std::size_t v = 0; v < count; ++v)
      mesh_.vertices.push_back(places[places.size() > 1 ? v : 0] * Vec3(p[3 * v], p[3 * v + 1], p[3 * v + 2]));
    std::vector<double> corners;
    if (primitive.contains("indices"))
      corners = document_.accessor(document_.whole(primitive, "indices"), 1);
    else
      for (std::size_t v = 0; v < count; ++v) corners.push_back(static_cast<double>(v));
    if (!std::ranges::all_of(corners, [&](double v) { return v >= 0.0 && v < static_cast<double>(count); }))
      document_.fail("a face names a vertex that does not exist");
    if (mode == kTriangles && corners.size() % 3 != 0) document_.fail("the last triangle of a primitive is not whole");
    append_faces(corners, mode, static_cast<int>(first), places.front().linear().determinant() < 0.0);
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
  std::size_t shown_ = 0, flattened_ = 0;
  std::vector<std::string> hidden_;   // nodes that their author made invisible
  std::vector<std::size_t> parents_;  // of the nodes; their number stands for none
  // Of the node that is read:
  std::vector<Eigen::Affine3d> joints_;  // of its skin; empty without one
  std::vector<double> weights_;          // of its morph targets
};

}  // namespace

MeshInUnit read_gltf(const MeshSource& source) {
  return GltfReader(source).read();
}

}  // namespace triskin::mesh
