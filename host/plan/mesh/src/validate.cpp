// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <span>

#include "crossing_search.hpp"
#include "edge_sides.hpp"
#include "triskin/base/error.hpp"
#include "triskin/base/index.hpp"
#include "triskin/base/parallel.hpp"
#include "triskin/mesh/extract.hpp"
#include "triskin/mesh/extract_steps.hpp"

namespace triskin::mesh {
namespace {

std::string place(const Vec3& p) {
  return fmt::format("({:.2f}, {:.2f}, {:.2f}) mm", p.x(), p.y(), p.z());
}

}  // namespace

void require_manifold(const Mesh& mesh, const std::string& name) {
  std::optional<EdgeSide> first;
  std::size_t faces = 0;
  int total = 0;
  const EdgeSides sides(mesh);
  sides.each_edge([&](std::span<const EdgeSide> edge) {
    if (edge.size() <= 2 || ++total > 1) return;
    first = edge[0];
    faces = edge.size();
  });
  if (!first) return;
  throw InputError(fmt::format(
      "{}: not a manifold: the edge from {} to {} has {} faces ({} such edges); run `triskin extract` first and "
      "design its surface",
      name, place(mesh.vertices[at(first->low)]), place(mesh.vertices[at(first->high)]), faces, total));
}

std::vector<FacePair> crossing_faces(const Mesh& surface, int threads) {
  return find_crossings(surface, {.threads = threads}).pairs;
}

bool crosses_itself(const Mesh& surface) {
  return !find_crossings(surface, {.threads = all_threads(), .any_one = true}).pairs.empty();
}

void require_no_self_intersection(const Mesh& surface, const std::string& name) {
  const auto crossings = crossing_faces(surface);
  if (crossings.empty()) return;
  const auto& f = surface.faces[at(crossings.front().first)];
  const Vec3 middle = (surface.vertices[at(f[0])] + surface.vertices[at(f[1])] + surface.vertices[at(f[2])]) / 3.0;
  throw InputError(fmt::format("{}: the surface intersects itself near {} ({} pairs of faces); repair the mesh there",
                               name, place(middle), crossings.size()));
}

}  // namespace triskin::mesh
