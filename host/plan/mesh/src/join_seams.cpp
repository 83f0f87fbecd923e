// SPDX-License-Identifier: GPL-3.0-or-later
#include "join_seams.hpp"

#include <algorithm>
#include <array>
#include <map>
#include <span>
#include <utility>
#include <vector>

#include "edge_sides.hpp"
#include "triskin/base/index.hpp"
#include "triskin/geometry/segment.hpp"
#include "triskin/mesh/bvh.hpp"

namespace triskin::mesh {
namespace {

using Face = std::array<int, 3>;

std::vector<EdgeSide> border_of(const Mesh& mesh) {
  std::vector<EdgeSide> border;
  const EdgeSides sides(mesh);
  sides.each_edge([&](std::span<const EdgeSide> edge) {
    if (edge.size() == 1 && edge[0].low != edge[0].high) border.push_back(edge[0]);
  });
  return border;
}

std::vector<VertexIndex> vertices_of(const std::vector<EdgeSide>& border) {
  std::vector<VertexIndex> vertices;
  for (const EdgeSide& side : border) vertices.insert(vertices.end(), {side.low, side.high});
  std::ranges::sort(vertices);
  vertices.erase(std::ranges::unique(vertices).begin(), vertices.end());
  return vertices;
}

// Gives each border vertex that lies within reach of one with a lower number the place of that one.
int merge_border_vertices(Mesh& mesh, const std::vector<VertexIndex>& vertices, double within_mm) {
  std::vector<Bvh::Extent> places;
  for (const VertexIndex v : vertices) places.push_back({mesh.vertices[at(v)].array(), mesh.vertices[at(v)].array()});
  const Bvh tree(places);
  std::map<int, int> target;
  for (const VertexIndex v : vertices) {
    double reach_squared = within_mm * within_mm;
    VertexIndex lowest = v;
    tree.nearest(mesh.vertices[at(v)], reach_squared, [&](int item) {
      const VertexIndex other = vertices[at(item)];
      const bool is_near = (mesh.vertices[at(other)] - mesh.vertices[at(v)]).squaredNorm() <= within_mm * within_mm;
      if (is_near && other < lowest && !target.contains(other)) lowest = other;
    });
    if (lowest != v) target.emplace(v, lowest);
  }
  if (target.empty()) return 0;
  for (Face& face : mesh.faces) {
    for (int& v : face) {
      if (const auto found = target.find(v); found != target.end()) v = found->second;
    }
  }
  return static_cast<int>(target.size());
}

// A side of a face and the border vertices on it, from its start to its end, which belong to both.
struct DividedSide {
  EdgeSide side;
  std::vector<int> vertices;
};

std::vector<DividedSide> divided_sides(const Mesh& mesh, const std::vector<EdgeSide>& border, double within_mm) {
  std::vector<Bvh::Extent> extents;
  std::vector<DividedSide> sides;
  std::vector<std::vector<std::pair<double, int>>> on_side(border.size());
  for (const EdgeSide& side : border) {
    const Face& face = mesh.faces[at(side.face)];
    const auto k = at(side.side);
    sides.push_back({side, {face[k], face[(k + 1) % 3]}});
    const auto a = mesh.vertices[at(side.low)].array(), b = mesh.vertices[at(side.high)].array();
    extents.push_back({Eigen::Array3d(a.min(b)), Eigen::Array3d(a.max(b))});
  }
  const Bvh tree(extents);
  for (const VertexIndex v : vertices_of(border)) {
    const Vec3& p = mesh.vertices[at(v)];
    double reach_squared = within_mm * within_mm;
    tree.nearest(p, reach_squared, [&](int item) {
      const auto n = at(item);
      const Vec3 &from = mesh.vertices[at(sides[n].vertices.front())],
                 &to = mesh.vertices[at(sides[n].vertices.back())];
      const bool is_end = std::min((p - from).norm(), (p - to).norm()) <= within_mm;
      if (is_end || geometry::distance_to_segment(p, from, to) > within_mm) return;
      if (std::ranges::count(mesh.faces[at(sides[n].side.face)], v.value()) > 0) return;  // A needle's own corner.
      on_side[n].emplace_back(geometry::part_of_segment(p, from, to), v);
    });
  }
  for (std::size_t n = 0; n < sides.size(); ++n) {
    std::ranges::sort(on_side[n]);
    auto& vertices = sides[n].vertices;
    for (const auto& [part, v] : on_side[n]) vertices.insert(vertices.end() - 1, v);
  }
  return sides;
}

// Keeps only the vertices next to a piece that exactly one other side has too: elsewhere dividing would join nothing.
void keep_joining(std::vector<DividedSide>& sides) {
  std::map<std::pair<int, int>, int> pieces;
  for (const auto& [side, vertices] : sides) {
    for (std::size_t k = 1; k < vertices.size(); ++k) ++pieces[std::minmax(vertices[k - 1], vertices[k])];
  }
  const auto is_shared = [&](int a, int b) { return pieces.at(std::minmax(a, b)) == 2; };
  for (auto& [side, vertices] : sides) {
    std::vector<int> kept{vertices.front()};
    for (std::size_t k = 1; k + 1 < vertices.size(); ++k) {
      if (is_shared(vertices[k - 1], vertices[k]) || is_shared(vertices[k], vertices[k + 1]))
        kept.push_back(vertices[k]);
    }
    kept.push_back(vertices.back());
    vertices = std::move(kept);
  }
}

// Divides a face by lines from each vertex on a side to the opposite corner, side by side.
void divide(const Face& face, const std::array<std::span<const int>, 3>& on_side, Mesh& mesh,
            std::vector<Face>& faces) {
  for (std::size_t s = 0; s < 3; ++s) {
    if (on_side[s].empty()) continue;
    const std::size_t next = (s + 1) % 3, last = (s + 2) % 3;
    const int v = on_side[s].front();
    std::array<std::span<const int>, 3> rest = on_side;
    rest[s] = on_side[s].subspan(1);
    rest[last] = {};
    Face behind = face, ahead = face;
    behind[next] = v;
    ahead[s] = v;
    std::array<std::span<const int>, 3> first{};
    first[last] = on_side[last];
    divide(behind, first, mesh, faces);
    divide(ahead, rest, mesh, faces);
    return;
  }
  faces.push_back(face);
}

int divide_t_junctions(Mesh& mesh, std::vector<DividedSide> sides) {
  std::erase_if(sides, [](const DividedSide& s) { return s.vertices.size() == 2; });
  std::ranges::sort(sides, {}, [](const DividedSide& s) { return std::pair(s.side.face, s.side.side); });
  int divided = 0;
  std::vector<Face> more;
  for (std::size_t first = 0, end = 0; first < sides.size(); first = end) {
    const FaceIndex f = sides[first].side.face;
    std::array<std::span<const int>, 3> on_side{};
    for (; end < sides.size() && sides[end].side.face == f; ++end) {
      const auto inner = std::span<const int>(sides[end].vertices).subspan(1, sides[end].vertices.size() - 2);
      on_side[at(sides[end].side.side)] = inner;
      divided += static_cast<int>(inner.size());
    }
    std::vector<Face> parts;
    divide(mesh.faces[at(f)], on_side, mesh, parts);
    mesh.faces[at(f)] = parts.front();
    more.insert(more.end(), parts.begin() + 1, parts.end());
  }
  mesh.faces.insert(mesh.faces.end(), more.begin(), more.end());
  return divided;
}

}  // namespace

void join_seams(Mesh& mesh, double within_mm, MeshReadReport& report) {
  std::vector<EdgeSide> border = border_of(mesh);
  if (border.empty()) return;
  if (const int merged = merge_border_vertices(mesh, vertices_of(border), within_mm); merged > 0) {
    report.welded_vertices += merged;
    border = border_of(mesh);
  }
  std::vector<DividedSide> sides = divided_sides(mesh, border, within_mm);
  keep_joining(sides);
  report.joined_corners += divide_t_junctions(mesh, std::move(sides));
}

}  // namespace triskin::mesh
