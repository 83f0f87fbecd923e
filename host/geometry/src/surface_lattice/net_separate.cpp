// SPDX-License-Identifier: GPL-3.0-or-later
// What a net does after changes: fans and islands that no longer hang together are parted.
#include <algorithm>
#include <utility>

#include "net.hpp"

namespace triskin::geometry::surface_lattice {

void LatticeNet::separate() {
  std::ranges::sort(loose_vertices_);
  const auto twice = std::ranges::unique(loose_vertices_);
  loose_vertices_.erase(twice.begin(), twice.end());
  const std::vector<int> loose = std::exchange(loose_vertices_, {});
  for (const int v : loose) {
    if (vertices_[at(v)].valence > 1) split_fans(v);
  }
  part_islands();
}

// Triangles round a vertex that are not joined side by side get copies of it.
void LatticeNet::split_fans(int vertex) {
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

// An island hangs together as before unless triangles were removed from it: then what stood beside them is asked.
void LatticeNet::part_islands() {
  std::erase_if(beside_removed_, [&](int t) { return !used(t); });
  std::ranges::sort(beside_removed_, {}, [&](int t) { return std::pair(triangles_[at(t)].island, t); });
  const auto twice = std::ranges::unique(beside_removed_);
  beside_removed_.erase(twice.begin(), twice.end());
  front_of_.resize(triangles_.size(), -1);
  for (std::size_t from = 0; from < beside_removed_.size();) {
    const int island = triangles_[at(beside_removed_[from])].island;
    std::vector<int> beside;
    for (; from < beside_removed_.size() && triangles_[at(beside_removed_[from])].island == island; ++from)
      beside.push_back(beside_removed_[from]);
    if (beside.size() > 1) part_island(beside);
  }
  beside_removed_.clear();
}

// Breadth-first searches from all of them, one triangle of each in turn; those that meet go on as one. A search that
// comes to its end is a part of its own; when only one goes on, what it has not seen need not be looked at.
void LatticeNet::part_island(const std::vector<int>& beside_removed) {
  struct Search {
    std::vector<int> triangles;
    std::size_t seen = 0;
  };
  std::vector<Search> searches(beside_removed.size());
  std::vector<int> leader(searches.size());
  const auto find = [&](int k) {
    while (leader[at(k)] != k) k = leader[at(k)] = leader[at(leader[at(k)])];
    return k;
  };
  for (std::size_t k = 0; k < searches.size(); ++k) {
    leader[k] = static_cast<int>(k);
    searches[k].triangles.push_back(beside_removed[k]);
    front_of_[at(beside_removed[k])] = static_cast<int>(k);
  }
  const auto expand = [&](int k) {
    const int t = searches[at(k)].triangles[searches[at(k)].seen++];
    for (int s = 0; s < 3; ++s) {
      const int n = neighbour(t, s);
      if (n < 0) continue;
      if (front_of_[at(n)] < 0) {
        front_of_[at(n)] = k;
        searches[at(k)].triangles.push_back(n);
      } else if (const int other = find(front_of_[at(n)]); other != find(k)) {
        leader[at(other)] = find(k);
      }
    }
  };
  const auto is_open = [&](const Search& s) { return s.seen < s.triangles.size(); };
  for (;;) {
    std::vector<int> open;  // leaders of whom some search goes on
    for (std::size_t k = 0; k < searches.size(); ++k) {
      if (is_open(searches[k])) open.push_back(find(static_cast<int>(k)));
    }
    std::ranges::sort(open);
    const auto twice = std::ranges::unique(open);
    open.erase(twice.begin(), twice.end());
    int parts = 0;
    for (std::size_t k = 0; k < searches.size(); ++k) parts += find(static_cast<int>(k)) == static_cast<int>(k) ? 1 : 0;
    if (parts == 1 || open.empty()) break;
    if (open.size() == 1) break;
    for (std::size_t k = 0; k < searches.size(); ++k) {
      if (is_open(searches[k])) expand(static_cast<int>(k));
    }
  }
  // The part that is still open keeps the number, or the first when all were seen to their ends.
  int keeps = find(0);
  for (std::size_t k = 0; k < searches.size(); ++k) {
    if (is_open(searches[k])) keeps = find(static_cast<int>(k));
  }
  std::vector<std::vector<int>> parts(searches.size());
  for (std::size_t k = 0; k < searches.size(); ++k) {
    for (const int t : searches[k].triangles) front_of_[at(t)] = -1;
    const int part = find(static_cast<int>(k));
    if (part != keeps)
      parts[at(part)].insert(parts[at(part)].end(), searches[k].triangles.begin(), searches[k].triangles.end());
  }
  for (const std::vector<int>& part : parts) {
    if (!part.empty()) give_island(part, new_island());
  }
}

void LatticeNet::give_island(const std::vector<int>& triangles, int island) {
  for (const int t : triangles) {
    remove_from_index(t);
    touch(t);
    triangles_[at(t)].island = island;
    index(t);
  }
}

}  // namespace triskin::geometry::surface_lattice
