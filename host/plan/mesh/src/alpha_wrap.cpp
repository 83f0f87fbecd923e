// SPDX-License-Identifier: GPL-3.0-or-later
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Surface_mesh.h>
#include <CGAL/alpha_wrap_3.h>

#include "clean.hpp"
#include "isolated.hpp"
#include "triskin/mesh/extract_steps.hpp"

namespace triskin::mesh {
namespace {

Mesh wrap_of(const Mesh& mesh, double alpha_mm, double offset_mm) {
  using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
  using Wrap = CGAL::Surface_mesh<Kernel::Point_3>;
  std::vector<Kernel::Point_3> points;
  std::vector<std::vector<std::size_t>> faces;
  for (const Vec3& v : mesh.vertices) points.emplace_back(v.x(), v.y(), v.z());
  for (const auto& f : mesh.faces)
    faces.push_back({static_cast<std::size_t>(f[0]), static_cast<std::size_t>(f[1]), static_cast<std::size_t>(f[2])});
  Wrap wrap;
  CGAL::alpha_wrap_3(points, faces, alpha_mm, offset_mm, wrap);
  Mesh result;
  std::vector<int> index(wrap.number_of_vertices(), -1);
  for (const auto v : wrap.vertices()) {
    index[v] = static_cast<int>(result.vertices.size());
    result.vertices.emplace_back(wrap.point(v).x(), wrap.point(v).y(), wrap.point(v).z());
  }
  for (const auto f : wrap.faces()) {
    std::array<int, 3> corners{};
    std::size_t k = 0;
    for (const auto v : wrap.vertices_around_face(wrap.halfedge(f))) corners[k++] = index[v];
    result.faces.push_back(corners);
  }
  return result;
}

}  // namespace

std::optional<Mesh> wrapped(const Mesh& mesh, double alpha_mm, double offset_mm, unsigned cpu_s,
                            const IsLate& is_late) {
  const auto answer =
      run_isolated([&] { return bytes_of(wrap_of(mesh, alpha_mm, offset_mm)); }, {.cpu_s = cpu_s}, is_late);
  if (!answer) return std::nullopt;
  return mesh_of(*answer);
}

}  // namespace triskin::mesh
