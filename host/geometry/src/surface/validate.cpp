// SPDX-License-Identifier: GPL-3.0-or-later
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Polygon_mesh_processing/self_intersections.h>
#include <CGAL/Surface_mesh.h>
#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <span>

#include "edge_sides.hpp"
#include "extract_steps.hpp"
#include "index.hpp"
#include "triskin/geometry/extract.hpp"
#include "triskin/host/error.hpp"

namespace triskin::geometry {
namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using SurfaceMesh = CGAL::Surface_mesh<Kernel::Point_3>;

std::string place(const Vec3& p) {
  return fmt::format("({:.2f}, {:.2f}, {:.2f}) mm", p.x(), p.y(), p.z());
}

struct CheckedMesh {
  explicit CheckedMesh(const Mesh& surface) {
    std::vector<SurfaceMesh::Vertex_index> vertex;
    vertex.reserve(surface.vertices.size());
    for (const Vec3& v : surface.vertices) vertex.push_back(mesh.add_vertex({v.x(), v.y(), v.z()}));
    for (std::size_t f = 0; f < surface.faces.size(); ++f) {
      const auto& c = surface.faces[f];
      const auto added = mesh.add_face(vertex[at(c[0])], vertex[at(c[1])], vertex[at(c[2])]);
      if (added != SurfaceMesh::null_face()) face.push_back(static_cast<int>(f));
    }
  }

  SurfaceMesh mesh;
  std::vector<int> face;  // of the surface, by that of `mesh`, which numbers those that it takes
};

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

std::vector<std::pair<int, int>> crossing_faces(const Mesh& surface) {
  const CheckedMesh checked(surface);
  std::vector<std::pair<SurfaceMesh::Face_index, SurfaceMesh::Face_index>> crossings;
  // In one thread: the dividing asks in a child process, which has no others.
  CGAL::Polygon_mesh_processing::self_intersections(checked.mesh, std::back_inserter(crossings));
  std::vector<std::pair<int, int>> pairs;
  for (const auto& [a, b] : crossings) pairs.push_back(std::minmax({checked.face[a], checked.face[b]}));
  std::ranges::sort(pairs);
  return pairs;
}

bool crosses_itself(const Mesh& surface) {
  return CGAL::Polygon_mesh_processing::does_self_intersect(CheckedMesh(surface).mesh);
}

void require_no_self_intersection(const Mesh& surface, const std::string& name) {
  const auto crossings = crossing_faces(surface);
  if (crossings.empty()) return;
  const auto& f = surface.faces[at(crossings.front().first)];
  const Vec3 middle = (surface.vertices[at(f[0])] + surface.vertices[at(f[1])] + surface.vertices[at(f[2])]) / 3.0;
  throw InputError(fmt::format("{}: the surface intersects itself near {} ({} pairs of faces); repair the mesh there",
                               name, place(middle), crossings.size()));
}

}  // namespace triskin::geometry
