// SPDX-License-Identifier: GPL-3.0-or-later
#include "net.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <set>

namespace triskin::geometry::surface_lattice {

// Three points fix the plane; within it the best turn is the mean of the turns of the three corners, weighted by their
// distance (the planar case of Kabsch's fit, as complex numbers).
Triangle fit_rigid(const Triangle& target) {
  const Vec3 center = (target[0] + target[1] + target[2]) / 3.0;
  const Vec3 normal = (target[1] - target[0]).cross(target[2] - target[0]).normalized();
  const Vec3 x = (target[1] - target[0]).normalized(), y = normal.cross(x);
  constexpr double kRadius = 2.0 * kHeight_mm / 3.0;
  static const std::array<std::complex<double>, 3> kRest{std::polar(kRadius, -5 * M_PI / 6), std::polar(kRadius, -M_PI / 6),
                                                         std::polar(kRadius, M_PI / 2)};
  std::complex<double> turn = 0.0;
  for (std::size_t k = 0; k < 3; ++k) {
    const Vec3 d = target[k] - center;
    turn += std::complex<double>(d.dot(x), d.dot(y)) * std::conj(kRest[k]);
  }
  turn /= std::abs(turn);
  Triangle rigid;
  for (std::size_t k = 0; k < 3; ++k) {
    const std::complex<double> z = turn * kRest[k];
    rigid[k] = center + z.real() * x + z.imag() * y;
  }
  return rigid;
}

int LatticeNet::islands() const {
  std::set<int> seen;
  for (const NetTriangle& t : triangles) {
    if (t.island >= 0) seen.insert(t.island);
  }
  return static_cast<int>(seen.size());
}

int LatticeNet::joints() const {
  int sides = 0;
  for (int t = 0; t < static_cast<int>(triangles.size()); ++t) {
    if (!used(t)) continue;
    for (int s = 0; s < 3; ++s) sides += neighbour(t, s) >= 0 ? 1 : 0;
  }
  return sides / 2;
}

bool LatticeNet::has_tile(int island, const Tile& tile) const {
  return std::ranges::any_of(triangles, [&](const NetTriangle& t) { return t.island == island && t.tile == tile; });
}

int LatticeNet::neighbour(int triangle, int side) const {
  const auto& v = triangles[at(triangle)].vertex;
  const NetVertex& a = vertices[at(v[at(side)])];
  const int b = v[at((side + 1) % 3)];
  for (int k = 0; k < a.valence; ++k) {
    const int other = a.triangles[at(k)];
    if (other == triangle) continue;
    const auto& w = triangles[at(other)].vertex;
    if (w[0] == b || w[1] == b || w[2] == b) return other;
  }
  return -1;
}

bool LatticeNet::joined(int a, int b) const {
  int shared = 0;
  for (const int v : triangles[at(a)].vertex) shared += static_cast<int>(std::ranges::count(triangles[at(b)].vertex, v));
  return shared >= 2;
}

int LatticeNet::add_vertex(const Vec3& point, const Vec3& normal, int i, int j) {
  NetVertex v;
  v.point = point;
  v.normal = normal;
  v.i = i;
  v.j = j;
  v.used = true;
  const auto unused = std::ranges::find_if(vertices, [](const NetVertex& w) { return !w.used; });
  if (unused == vertices.end()) {
    vertices.push_back(v);
    return static_cast<int>(vertices.size()) - 1;
  }
  *unused = v;
  return static_cast<int>(unused - vertices.begin());
}

int LatticeNet::add_triangle(int island, const Tile& tile, const std::array<int, 3>& vertex) {
  int slot = static_cast<int>(triangles.size());
  if (free_triangles_.empty()) {
    triangles.emplace_back();
  } else {
    slot = free_triangles_.back();
    free_triangles_.pop_back();
  }
  NetTriangle& t = triangles[at(slot)];
  t.vertex = vertex;
  t.tile = tile;
  t.island = island;
  for (const int v : vertex) {
    NetVertex& w = vertices[at(v)];
    w.triangles[at(w.valence++)] = slot;
  }
  ++size_;
  fit(slot);
  return slot;
}

void LatticeNet::remove_triangle(int triangle) {
  for (const int v : triangles[at(triangle)].vertex) {
    NetVertex& w = vertices[at(v)];
    const auto end = w.triangles.begin() + w.valence;
    std::remove(w.triangles.begin(), end, triangle);
    w.used = --w.valence > 0;
  }
  triangles[at(triangle)].island = -1;
  free_triangles_.push_back(triangle);
  --size_;
}

void LatticeNet::fit(int triangle) {
  NetTriangle& t = triangles[at(triangle)];
  t.rigid = fit_rigid({vertices[at(t.vertex[0])].point, vertices[at(t.vertex[1])].point, vertices[at(t.vertex[2])].point});
  t.center = (t.rigid[0] + t.rigid[1] + t.rigid[2]) / 3.0;
  t.normal = (t.rigid[1] - t.rigid[0]).cross(t.rigid[2] - t.rigid[0]).normalized();
}

void LatticeNet::separate() {
  const int count = static_cast<int>(vertices.size());
  for (int v = 0; v < count; ++v) {
    if (vertices[at(v)].valence > 1) split_fans(v);
  }
  renumber_islands();
}

// Triangles round a vertex that are not joined side by side get copies of it.
void LatticeNet::split_fans(int vertex) {
  std::vector<int> rest(vertices[at(vertex)].triangles.begin(), vertices[at(vertex)].triangles.begin() + vertices[at(vertex)].valence);
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
    NetVertex copy = vertices[at(vertex)];
    copy.valence = static_cast<int>(fan.size());
    std::ranges::copy(fan, copy.triangles.begin());
    if (first) {
      vertices[at(vertex)] = copy;
    } else {
      const int fresh = add_vertex(copy.point, copy.normal, copy.i, copy.j);
      vertices[at(fresh)] = copy;
      for (const int t : fan) std::ranges::replace(triangles[at(t)].vertex, vertex, fresh);
    }
    first = false;
  }
}

void LatticeNet::renumber_islands() {
  std::vector<int> island(triangles.size(), -1);
  next_island_ = 0;
  for (int first = 0; first < static_cast<int>(triangles.size()); ++first) {
    if (!used(first) || island[at(first)] >= 0) continue;
    std::vector<int> queue{first};
    island[at(first)] = next_island_;
    for (std::size_t q = 0; q < queue.size(); ++q) {
      for (int s = 0; s < 3; ++s) {
        const int n = neighbour(queue[q], s);
        if (n < 0 || island[at(n)] >= 0) continue;
        island[at(n)] = next_island_;
        queue.push_back(n);
      }
    }
    ++next_island_;
  }
  for (std::size_t t = 0; t < triangles.size(); ++t) triangles[t].island = island[t];
}

}  // namespace triskin::geometry::surface_lattice
