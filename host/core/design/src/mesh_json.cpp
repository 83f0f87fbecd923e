// SPDX-License-Identifier: GPL-3.0-or-later
#include "mesh_json.hpp"

#include <nlohmann/json.hpp>

#include "triskin/design/json_fields.hpp"

namespace triskin::design {

nlohmann::json mesh_json(const Mesh& mesh) {
  nlohmann::json vertices = nlohmann::json::array();
  for (const Vec3& p : mesh.vertices) vertices.push_back({p.x(), p.y(), p.z()});
  return {{"vertices", std::move(vertices)}, {"faces", mesh.faces}};
}

Mesh read_mesh_json(const JsonValue& v) {
  only_keys(v, {"vertices", "faces"}, "docs/design_file.md");
  Mesh mesh;
  const JsonValue vertices = v["vertices"], faces = v["faces"];
  for (std::size_t k = 0; k < vertices.size(); ++k) mesh.vertices.push_back(vec3(vertices.at(k)));
  const int last = static_cast<int>(mesh.vertices.size()) - 1;
  for (std::size_t k = 0; k < faces.size(); ++k) {
    const JsonValue f = faces.at(k);
    f.require_size(3);
    mesh.faces.push_back({f.at(0).integer(0, last), f.at(1).integer(0, last), f.at(2).integer(0, last)});
  }
  return mesh;
}

}  // namespace triskin::design
