// SPDX-License-Identifier: GPL-3.0-or-later
#include "dart.hpp"

#include <algorithm>
#include <map>
#include <queue>

#include "triskin/base/index.hpp"

namespace triskin::unfolding {
namespace {

struct Reached {
  double distance = 1e300;
  VertexIndex before = VertexIndex::none();
  SurfaceEdge edge;
};

struct Inside {
  // Lists the edges between two faces of the set, in both directions.
  std::map<VertexIndex, std::vector<std::pair<VertexIndex, SurfaceEdge>>> from;
  std::set<VertexIndex> border;  // These vertices belong to edges with a single face of the set.
};

Inside inside_of(const CutSurface& cut, const std::vector<FaceIndex>& faces, const std::set<VertexPair>& uncut) {
  Inside in;
  for (const FaceIndex f : faces) {
    const auto& c = cut.surface().mesh().faces[at(f)];
    for (int s = 0; s < 3; ++s) {
      const VertexIndex a(c[at(s)]), b(c[at((s + 1) % 3)]);
      const FaceIndex n = cut.neighbour(f, s);
      if (n < 0 || !std::ranges::binary_search(faces, n)) {
        in.border.insert({a, b});
      } else if (!uncut.contains(std::minmax(a, b))) {
        in.from[a].push_back({b, {f, s}});
        in.from[b].push_back({a, {f, s}});
      }
    }
  }
  return in;
}

}  // namespace

std::vector<SurfaceEdge> deepest_dart(const CutSurface& cut, const std::vector<FaceIndex>& faces,
                                      const std::set<VertexPair>& uncut) {
  const Inside in = inside_of(cut, faces, uncut);
  const auto& v = cut.surface().mesh().vertices;
  std::map<VertexIndex, Reached> reached;
  using Item = std::pair<double, VertexIndex>;
  std::priority_queue<Item, std::vector<Item>, std::greater<>> queue;
  for (const VertexIndex b : in.border) {
    reached[b].distance = 0.0;
    queue.emplace(0.0, b);
  }
  VertexIndex deepest = VertexIndex::none();
  while (!queue.empty()) {
    const auto [distance, a] = queue.top();
    queue.pop();
    if (distance > reached[a].distance) continue;
    if (distance > 0.0) deepest = a;  // Vertices are visited in the order of their distance.
    const auto edges = in.from.find(a);
    if (edges == in.from.end()) continue;
    for (const auto& [b, edge] : edges->second) {
      const double next = distance + (v[at(b)] - v[at(a)]).norm();
      Reached& there = reached[b];
      if (!(next < there.distance)) continue;
      there = {next, a, edge};
      queue.emplace(next, b);
    }
  }
  std::vector<SurfaceEdge> dart;
  for (VertexIndex a = deepest; a >= 0 && reached[a].before >= 0; a = reached[a].before)
    dart.push_back(reached[a].edge);
  return dart;
}

}  // namespace triskin::unfolding
