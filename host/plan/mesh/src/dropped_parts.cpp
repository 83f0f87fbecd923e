// SPDX-License-Identifier: GPL-3.0-or-later
#include "dropped_parts.hpp"

#include <algorithm>
#include <numeric>

#include "triskin/base/index.hpp"

namespace triskin::mesh {

geometry::Triangle triangle_of(const Mesh& mesh, FaceIndex face) {
  const auto& [a, b, c] = mesh.faces[at(face)];
  return {mesh.vertices[at(a)], mesh.vertices[at(b)], mesh.vertices[at(c)]};
}

Triangles::Triangles(const Mesh& mesh) {
  keys_.reserve(mesh.faces.size());
  for (FaceIndex f{0}; f < static_cast<int>(mesh.faces.size()); ++f) keys_.push_back(key_of(triangle_of(mesh, f)));
  std::ranges::sort(keys_);
}

bool Triangles::contains(const geometry::Triangle& t) const {
  return std::ranges::binary_search(keys_, key_of(t));
}

Triangles::Key Triangles::key_of(const geometry::Triangle& t) {
  Key key;
  for (std::size_t k = 0; k < 3; ++k) key[k] = {t[k].x(), t[k].y(), t[k].z()};
  std::ranges::sort(key);
  return key;
}

std::vector<DroppedPart> parts_of_faces(const Mesh& mesh, const std::vector<bool>& is_dropped) {
  std::vector<std::optional<double>> missing_mm2(mesh.faces.size());
  for (FaceIndex f{0}; f < static_cast<int>(mesh.faces.size()); ++f) {
    if (is_dropped[at(f)]) missing_mm2[at(f)] = geometry::area_of(triangle_of(mesh, f));
  }
  return parts_of_faces(mesh, missing_mm2);
}

std::vector<DroppedPart> parts_of_faces(const Mesh& mesh, const std::vector<std::optional<double>>& missing_mm2) {
  std::vector<int> root(mesh.vertices.size());
  std::iota(root.begin(), root.end(), 0);
  const auto root_of = [&](int v) {
    auto k = at(v);
    while (root[k] != static_cast<int>(k)) k = at(root[k] = root[at(root[k])]);
    return k;
  };
  for (FaceIndex f{0}; f < static_cast<int>(mesh.faces.size()); ++f) {
    if (!missing_mm2[at(f)]) continue;
    const auto& face = mesh.faces[at(f)];
    for (std::size_t k = 1; k < 3; ++k) root[root_of(face[k])] = static_cast<int>(root_of(face[0]));
  }
  std::vector<DroppedPart> parts;
  std::vector<double> largest_mm2;
  std::vector<std::size_t> part_of_root(mesh.vertices.size(), mesh.faces.size());
  for (FaceIndex f{0}; f < static_cast<int>(mesh.faces.size()); ++f) {
    if (!missing_mm2[at(f)]) continue;
    std::size_t& part = part_of_root[root_of(mesh.faces[at(f)][0])];
    if (part == mesh.faces.size()) {
      part = parts.size();
      parts.emplace_back();
      largest_mm2.push_back(-1.0);
    }
    const geometry::Triangle t = triangle_of(mesh, f);
    parts[part].area_mm2 += *missing_mm2[at(f)];
    ++parts[part].faces;
    if (*missing_mm2[at(f)] <= largest_mm2[part]) continue;
    largest_mm2[part] = *missing_mm2[at(f)];
    parts[part].where_mm = (t[0] + t[1] + t[2]) / 3.0;
  }
  return parts;
}

void name_dropped(const Mesh& before, const Mesh& after, std::vector<DroppedPart>& dropped) {
  const Triangles kept(after);
  std::vector<bool> is_dropped(before.faces.size());
  for (FaceIndex f{0}; f < static_cast<int>(before.faces.size()); ++f)
    is_dropped[at(f)] = !kept.contains(triangle_of(before, f));
  const std::vector<DroppedPart> parts = parts_of_faces(before, is_dropped);
  dropped.insert(dropped.end(), parts.begin(), parts.end());
}

}  // namespace triskin::mesh
