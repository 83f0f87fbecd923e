// SPDX-License-Identifier: GPL-3.0-or-later
// Repairs a net after changes: separates fans and islands that are no longer connected.
#include <algorithm>
#include <utility>

#include "net.hpp"
#include "triskin/base/disjoint_sets.hpp"

namespace triskin::lattice {
namespace {

// Runs breadth-first searches from all triangles beside removed ones, one triangle of each in turn; searches that meet
// continue as one. A search that finishes is a separate part; when only one remains, the triangles that it has not seen
// need no visit.
class IslandSearch {
 public:
  // `search_of`, by triangle, must be −1 in all entries, and is so again afterwards.
  IslandSearch(const LatticeMesh& net, std::vector<int>& search_of, const std::vector<int>& from)
      : net_(net), search_of_(search_of), searches_(from.size()), met_(from.size()) {
    for (int k = 0; k < count(); ++k) reach(k, from[at(k)]);
  }

  // Returns the parts that need a new number: all but the one that is still open, or all but one when all were
  // finished.
  std::vector<std::vector<int>> parts() {
    while (several_open()) {
      for (int k = 0; k < count(); ++k) {
        if (is_open(k)) expand(k);
      }
    }
    int keeps = met_.find(0);
    for (int k = 0; k < count(); ++k) {
      if (is_open(k)) keeps = met_.find(k);
    }
    std::vector<std::vector<int>> of_leader(searches_.size());
    for (int k = 0; k < count(); ++k) {
      const std::vector<int>& reached = searches_[at(k)].reached;
      for (const int t : reached) search_of_[at(t)] = -1;
      std::vector<int>& part = of_leader[at(met_.find(k))];
      if (met_.find(k) != keeps) part.insert(part.end(), reached.begin(), reached.end());
    }
    std::erase_if(of_leader, [](const std::vector<int>& part) { return part.empty(); });
    return of_leader;
  }

 private:
  struct Search {
    std::vector<int> reached;
    std::size_t expanded = 0;
  };

  [[nodiscard]] int count() const { return static_cast<int>(searches_.size()); }
  [[nodiscard]] bool is_open(int k) const { return searches_[at(k)].expanded < searches_[at(k)].reached.size(); }

  void reach(int k, int triangle) {
    search_of_[at(triangle)] = k;
    searches_[at(k)].reached.push_back(triangle);
  }
  void expand(int k) {
    const int t = searches_[at(k)].reached[searches_[at(k)].expanded++];
    for (int s = 0; s < 3; ++s) {
      const int n = net_.neighbour(t, s);
      if (n < 0) continue;
      if (search_of_[at(n)] < 0)
        reach(k, n);
      else
        met_.join(search_of_[at(n)], k);
    }
  }
  // Tells whether searches that have not met are still running.
  [[nodiscard]] bool several_open() {
    int first = -1;
    for (int k = 0; k < count(); ++k) {
      if (!is_open(k)) continue;
      if (first >= 0 && met_.find(k) != first) return true;
      first = met_.find(k);
    }
    return false;
  }

  const LatticeMesh& net_;
  std::vector<int>& search_of_;
  std::vector<Search> searches_;
  DisjointSets met_;
};

}  // namespace

void LatticeMesh::separate() {
  std::ranges::sort(loose_vertices_);
  const auto twice = std::ranges::unique(loose_vertices_);
  loose_vertices_.erase(twice.begin(), twice.end());
  const std::vector<int> loose = std::exchange(loose_vertices_, {});
  for (const int v : loose) {
    if (vertices_[at(v)].valence > 1) split_fans(v);
  }
  part_islands();
}

// Triangles around a vertex that are not joined side by side get copies of it.
void LatticeMesh::split_fans(int vertex) {
  std::vector<int> rest(vertices_[at(vertex)].triangles.begin(),
                        vertices_[at(vertex)].triangles.begin() + vertices_[at(vertex)].valence);
  bool first = true;
  while (!rest.empty()) {
    std::vector<int> fan{rest.back()};
    rest.pop_back();
    for (std::size_t q = 0; q < fan.size(); ++q) {
      const auto is_near = [&](int t) { return joined(fan[q], t); };
      std::ranges::copy_if(rest, std::back_inserter(fan), is_near);
      std::erase_if(rest, is_near);
    }
    if (first && rest.empty()) return;
    NetVertex copy = vertices_[at(vertex)];
    copy.valence = static_cast<int>(fan.size());
    std::ranges::copy(fan, copy.triangles.begin());
    copy.is_fixed = std::ranges::any_of(fan, [&](int t) { return triangles_[at(t)].is_fixed; });
    if (first) {
      edit_vertex(vertex) = copy;
    } else {
      const int fresh = add_vertex(copy.point, copy.normal, copy.i, copy.j);
      edit_vertex(fresh) = copy;
      for (const int t : fan) {
        touch(t);
        std::ranges::replace(triangles_[at(t)].vertex, vertex, fresh);
      }
    }
    first = false;
  }
}

// An island stays connected unless triangles were removed from it, so only their neighbours are searched.
void LatticeMesh::part_islands() {
  std::erase_if(beside_removed_, [&](int t) { return !used(t); });
  std::ranges::sort(beside_removed_, {}, [&](int t) { return std::pair(triangles_[at(t)].island, t); });
  const auto twice = std::ranges::unique(beside_removed_);
  beside_removed_.erase(twice.begin(), twice.end());
  search_of_.resize(triangles_.size(), -1);
  for (std::size_t from = 0; from < beside_removed_.size();) {
    const int island = triangles_[at(beside_removed_[from])].island;
    std::vector<int> beside;
    for (; from < beside_removed_.size() && triangles_[at(beside_removed_[from])].island == island; ++from)
      beside.push_back(beside_removed_[from]);
    if (beside.size() > 1) part_island(beside);
  }
  beside_removed_.clear();
}

void LatticeMesh::part_island(const std::vector<int>& beside_removed) {
  IslandSearch search(*this, search_of_, beside_removed);
  for (const std::vector<int>& part : search.parts()) give_island(part, new_island());
}

void LatticeMesh::give_island(const std::vector<int>& triangles, int island) {
  for (const int t : triangles) {
    remove_from_index(t);
    touch(t);
    triangles_[at(t)].island = island;
    index(t);
  }
}

}  // namespace triskin::lattice
