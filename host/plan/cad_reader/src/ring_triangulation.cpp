// SPDX-License-Identifier: GPL-3.0-or-later
#include "ring_triangulation.hpp"

#include <CGAL/Constrained_Delaunay_triangulation_2.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Triangulation_face_base_with_info_2.h>
#include <CGAL/Triangulation_vertex_base_with_info_2.h>

#include <deque>

namespace triskin::cad_reader {
namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using VertexBase = CGAL::Triangulation_vertex_base_with_info_2<int, Kernel>;
using FaceBase =
    CGAL::Triangulation_face_base_with_info_2<int, Kernel, CGAL::Constrained_triangulation_face_base_2<Kernel>>;
using Triangulation =
    CGAL::Constrained_Delaunay_triangulation_2<Kernel, CGAL::Triangulation_data_structure_2<VertexBase, FaceBase>,
                                               CGAL::Exact_intersections_tag>;

constexpr int kUnseen = -1;

// Numbers each triangle by how many rings lie between it and the outside.
void mark_depths(Triangulation& triangulation) {
  for (auto f : triangulation.all_face_handles()) f->info() = kUnseen;
  std::deque<Triangulation::Face_handle> border{triangulation.infinite_face()}, deeper;
  border.front()->info() = 0;
  for (int depth = 0; !border.empty(); ++depth) {
    while (!border.empty()) {
      const auto f = border.front();
      border.pop_front();
      for (int side = 0; side < 3; ++side) {
        const auto neighbour = f->neighbor(side);
        const bool is_crossing = triangulation.is_constrained({f, side});
        if (neighbour->info() != kUnseen) continue;
        if (is_crossing) {
          deeper.push_back(neighbour);
        } else {
          neighbour->info() = depth;
          border.push_back(neighbour);
        }
      }
    }
    for (const auto& f : deeper) {
      if (f->info() != kUnseen) continue;
      f->info() = depth + 1;
      border.push_back(f);
    }
    deeper.clear();
  }
}

// Returns false if the ring crosses an existing edge, which would create a corner that no ring has.
bool insert_ring(Triangulation& triangulation, const std::vector<Eigen::Vector2d>& ring, int first) {
  std::vector<Triangulation::Vertex_handle> handles;
  for (const Eigen::Vector2d& p : ring) {
    const std::size_t before = triangulation.number_of_vertices();
    handles.push_back(triangulation.insert({p.x(), p.y()}));
    // A ring may touch itself in a corner (a seam); the first corner then represents both.
    if (triangulation.number_of_vertices() > before)
      handles.back()->info() = first + static_cast<int>(handles.size()) - 1;
  }
  const std::size_t corners = triangulation.number_of_vertices();
  for (std::size_t k = 0; k < handles.size(); ++k) {
    const auto& next = handles[(k + 1) % handles.size()];
    if (handles[k] != next) triangulation.insert_constraint(handles[k], next);
  }
  return triangulation.number_of_vertices() == corners;
}

}  // namespace

std::optional<std::vector<std::array<int, 3>>> triangulate_rings(
    const std::vector<std::vector<Eigen::Vector2d>>& rings) {
  Triangulation triangulation;
  int first = 0;
  for (const auto& ring : rings) {
    if (!insert_ring(triangulation, ring, first)) return std::nullopt;
    first += static_cast<int>(ring.size());
  }
  mark_depths(triangulation);
  std::vector<std::array<int, 3>> triangles;
  for (auto f : triangulation.finite_face_handles()) {
    if (f->info() % 2 == 0) continue;
    triangles.push_back({f->vertex(0)->info(), f->vertex(1)->info(), f->vertex(2)->info()});
  }
  return triangles;
}

}  // namespace triskin::cad_reader
