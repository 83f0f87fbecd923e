// SPDX-License-Identifier: GPL-3.0-or-later
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Polygon_mesh_processing/self_intersections.h>
#include <CGAL/Surface_mesh.h>
#include <fmt/format.h>

#include <algorithm>
#include <map>

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

}  // namespace

void require_manifold(const Mesh& mesh, const std::string& name) {
  std::map<std::pair<int, int>, int> count;
  for (const auto& f : mesh.faces) {
    for (std::size_t k = 0; k < 3; ++k) ++count[std::minmax(f[k], f[(k + 1) % 3])];
  }
  const auto bad = std::ranges::find_if(count, [](const auto& e) { return e.second > 2; });
  if (bad == count.end()) return;
  const auto total = std::ranges::count_if(count, [](const auto& e) { return e.second > 2; });
  throw InputError(fmt::format(
      "{}: not a manifold: the edge from {} to {} has {} faces ({} such edges); run `triskin extract` first and "
      "design its surface",
      name, place(mesh.vertices[at(bad->first.first)]), place(mesh.vertices[at(bad->first.second)]), bad->second,
      total));
}

std::vector<std::pair<int, int>> crossing_faces(const Mesh& surface) {
  SurfaceMesh mesh;
  std::vector<SurfaceMesh::Vertex_index> vertex;
  for (const Vec3& v : surface.vertices) vertex.push_back(mesh.add_vertex({v.x(), v.y(), v.z()}));
  std::map<SurfaceMesh::Face_index, int> index;
  for (std::size_t f = 0; f < surface.faces.size(); ++f) {
    const auto& c = surface.faces[f];
    const auto face = mesh.add_face(vertex[at(c[0])], vertex[at(c[1])], vertex[at(c[2])]);
    if (face != SurfaceMesh::null_face()) index[face] = static_cast<int>(f);
  }
  std::vector<std::pair<SurfaceMesh::Face_index, SurfaceMesh::Face_index>> crossings;
  CGAL::Polygon_mesh_processing::self_intersections(mesh, std::back_inserter(crossings));
  std::vector<std::pair<int, int>> pairs;
  for (const auto& [a, b] : crossings) pairs.push_back(std::minmax({index.at(a), index.at(b)}));
  std::ranges::sort(pairs);
  return pairs;
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
