// SPDX-License-Identifier: GPL-3.0-or-later
#include "edge_sides.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <optional>
#include <tuple>
#include <utility>

#include "triskin/base/error.hpp"
#include "triskin/base/index.hpp"

namespace triskin::mesh {

EdgeSides::EdgeSides(const Mesh& mesh) : sides_(3 * mesh.faces.size()) {
  // For each low vertex, this is the index of its first side.
  std::vector<std::size_t> begin(mesh.vertices.size() + 1, 0);
  const auto low_of = [&](const std::array<int, 3>& f, std::size_t s) { return std::min(f[s], f[(s + 1) % 3]); };
  for (const auto& f : mesh.faces) {
    for (std::size_t s = 0; s < 3; ++s) ++begin[at(low_of(f, s)) + 1];
  }
  for (std::size_t v = 1; v < begin.size(); ++v) begin[v] += begin[v - 1];
  std::vector<std::size_t> next = begin;
  for (std::size_t k = 0; k < mesh.faces.size(); ++k) {
    const auto& f = mesh.faces[k];
    for (std::size_t s = 0; s < 3; ++s) {
      const int low = low_of(f, s);
      sides_[next[at(low)]++] = {VertexIndex(low), VertexIndex(std::max(f[s], f[(s + 1) % 3])), FaceIndex(k),
                                 static_cast<int>(s)};
    }
  }
  for (std::size_t v = 0; v + 1 < begin.size(); ++v) {
    std::sort(sides_.begin() + static_cast<std::ptrdiff_t>(begin[v]),
              sides_.begin() + static_cast<std::ptrdiff_t>(begin[v + 1]), [](const EdgeSide& a, const EdgeSide& b) {
                return std::tie(a.high, a.face, a.side) < std::tie(b.high, b.face, b.side);
              });
  }
}

std::vector<std::array<FaceIndex, 3>> neighbours_of(const Mesh& mesh) {
  constexpr FaceIndex kNone = FaceIndex::none();
  std::vector<std::array<FaceIndex, 3>> neighbour(mesh.faces.size(), {kNone, kNone, kNone});
  const auto start = [&](const EdgeSide& s) { return mesh.faces[at(s.face)][at(s.side)]; };
  std::optional<EdgeSide> repeats;  // The first side that has the direction of an earlier one.
  const EdgeSides sides(mesh);
  sides.each_edge([&](std::span<const EdgeSide> edge) {
    for (std::size_t k = 1; k < edge.size(); ++k) {
      const bool is_new = k == 1 && start(edge[0]) != start(edge[1]);
      if (is_new || (repeats && std::pair(repeats->face, repeats->side) < std::pair(edge[k].face, edge[k].side)))
        continue;
      repeats = edge[k];
    }
    if (edge.size() != 2) return;
    neighbour[at(edge[0].face)][at(edge[0].side)] = edge[1].face;
    neighbour[at(edge[1].face)][at(edge[1].side)] = edge[0].face;
  });
  if (!repeats) return neighbour;
  throw InputError(
      fmt::format("surface: the edge from vertex {} to {} has more than two faces or faces of opposite "
                  "orientation (face {}); run `triskin extract` first",
                  start(*repeats), mesh.faces[at(repeats->face)][at((repeats->side + 1) % 3)], repeats->face));
}

std::optional<Vec3> one_sided_at(const Mesh& mesh) {
  struct Neighbour {
    FaceIndex face = FaceIndex::none();
    bool agrees = false;  // Both faces run through the edge in opposite directions.
  };
  std::vector<std::array<Neighbour, 3>> neighbours(mesh.faces.size());
  EdgeSides(mesh).each_edge([&](std::span<const EdgeSide> edge) {
    if (edge.size() != 2 || edge[0].face == edge[1].face) return;
    const auto start = [&](const EdgeSide& s) { return mesh.faces[at(s.face)][at(s.side)]; };
    const bool agrees = start(edge[0]) != start(edge[1]);
    neighbours[at(edge[0].face)][at(edge[0].side)] = {edge[1].face, agrees};
    neighbours[at(edge[1].face)][at(edge[1].side)] = {edge[0].face, agrees};
  });
  std::vector<int> turn(mesh.faces.size(), 0);  // 1: as in the file, -1: turned, 0: not visited
  std::vector<FaceIndex> queue;
  for (std::size_t first = 0; first < mesh.faces.size(); ++first) {
    if (turn[first] != 0) continue;
    turn[first] = 1;
    queue.assign(1, FaceIndex(first));
    while (!queue.empty()) {
      const FaceIndex f = queue.back();
      queue.pop_back();
      for (std::size_t s = 0; s < 3; ++s) {
        const Neighbour& n = neighbours[at(f)][s];
        if (n.face < 0) continue;
        const int wanted = n.agrees ? turn[at(f)] : -turn[at(f)];
        if (turn[at(n.face)] == 0) {
          turn[at(n.face)] = wanted;
          queue.push_back(n.face);
        } else if (turn[at(n.face)] != wanted) {
          return mesh.vertices[at(mesh.faces[at(f)][s])];
        }
      }
    }
  }
  return std::nullopt;
}

int non_manifold_edges_of(const Mesh& mesh) {
  int count = 0;
  const EdgeSides sides(mesh);
  sides.each_edge([&](std::span<const EdgeSide> edge) { count += edge.size() > 2 ? 1 : 0; });
  return count;
}

std::vector<std::vector<VertexIndex>> border_loops_of(const Mesh& mesh,
                                                      const std::vector<std::array<FaceIndex, 3>>& neighbours) {
  std::multimap<VertexIndex, VertexIndex> next;  // The key is the start vertex; a pinched vertex has several edges.
  for (std::size_t f = 0; f < mesh.faces.size(); ++f) {
    for (std::size_t s = 0; s < 3; ++s) {
      if (neighbours[f][s] < 0) next.emplace(mesh.faces[f][s], mesh.faces[f][(s + 1) % 3]);
    }
  }
  std::vector<std::vector<VertexIndex>> loops;
  while (!next.empty()) {
    std::vector<VertexIndex> loop;
    auto edge = next.begin();
    const VertexIndex start = edge->first;
    while (edge != next.end()) {
      loop.push_back(edge->first);
      const VertexIndex to = edge->second;
      next.erase(edge);
      if (to == start) break;
      edge = next.find(to);
    }
    loops.push_back(std::move(loop));
  }
  return loops;
}

double width_of_loop(const Mesh& mesh, const std::vector<VertexIndex>& loop) {
  double width = 0.0;
  for (const VertexIndex a : loop) {
    for (const VertexIndex b : loop) width = std::max(width, (mesh.vertices[at(a)] - mesh.vertices[at(b)]).norm());
  }
  return width;
}

}  // namespace triskin::mesh
