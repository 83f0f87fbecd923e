// SPDX-License-Identifier: GPL-3.0-or-later
#include "net.hpp"

#include <algorithm>
#include <cmath>

namespace triskin::geometry::surface_lattice {
namespace {

const Vec3 kNowhere = Vec3::Constant(1e12);

}  // namespace

// Three points fix the plane; within it the best turn is the mean of the turns of the three corners, weighted by their
// distance (the planar case of Kabsch's fit, as complex numbers). Corners of the rest pose, from its centre: 2/3 h at
// −150°, −30° and 90°, so that their conjugates are kRadius · (∓√3/2 + i/2), −i.
Triangle fit_rigid(const Triangle& target) {
  constexpr double kRadius = 2.0 * kHeight_mm / 3.0, kCos = 0.86602540378443864676;
  const Vec3 center = (target[0] + target[1] + target[2]) / 3.0;
  const Vec3 u = target[1] - target[0];
  const Vec3 x = u.normalized(), normal = u.cross(target[2] - target[0]).normalized(), y = normal.cross(x);
  const std::array<Vec3, 3> d{target[0] - center, target[1] - center, target[2] - center};
  const double x0 = d[0].dot(x), y0 = d[0].dot(y), x1 = d[1].dot(x), y1 = d[1].dot(y), x2 = d[2].dot(x),
               y2 = d[2].dot(y);
  double real = kCos * (x1 - x0) - 0.5 * (y0 + y1) + y2;
  double imaginary = kCos * (y1 - y0) + 0.5 * (x0 + x1) - x2;
  const double scale = kRadius / std::sqrt(real * real + imaginary * imaginary);
  const Vec3 right = scale * (real * x + imaginary * y), up = scale * (real * y - imaginary * x);
  return {Vec3(center - kCos * right - 0.5 * up), Vec3(center + kCos * right - 0.5 * up), Vec3(center + up)};
}

std::vector<int> LatticeNet::island_sizes() const {
  std::vector<int> size;
  for (const NetTriangle& t : triangles) {
    if (t.island < 0) continue;
    if (size.size() <= at(t.island)) size.resize(at(t.island) + 1);
    ++size[at(t.island)];
  }
  std::erase(size, 0);
  return size;
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
  const auto &v = triangles[at(a)].vertex, &w = triangles[at(b)].vertex;
  const auto has = [&w](int corner) { return w[0] == corner || w[1] == corner || w[2] == corner ? 1 : 0; };
  return has(v[0]) + has(v[1]) + has(v[2]) >= 2;
}

bool LatticeNet::in_fan(int a, int b) const {
  const auto &v = triangles[at(a)].vertex, &w = triangles[at(b)].vertex;
  for (const int corner : v) {
    if (w[0] != corner && w[1] != corner && w[2] != corner) continue;
    const NetVertex& shared = vertices[at(corner)];
    for (int k = 0; k < shared.valence; ++k) {
      const int t = shared.triangles[at(k)];
      if (t != a && t != b && joined(t, a) && joined(t, b)) return true;
    }
  }
  return false;
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
  int triangle = static_cast<int>(triangles.size());
  if (free_triangles_.empty()) {
    triangles.emplace_back();
    centers_.push_back(kNowhere);
  } else {
    triangle = free_triangles_.back();
    free_triangles_.pop_back();
  }
  NetTriangle& t = triangles[at(triangle)];
  t.vertex = vertex;
  t.tile = tile;
  t.island = island;
  for (const int v : vertex) {
    NetVertex& w = vertices[at(v)];
    w.triangles[at(w.valence++)] = triangle;
  }
  ++size_;
  fit(triangle);
  return triangle;
}

void LatticeNet::remove_triangle(int triangle) {
  for (const int v : triangles[at(triangle)].vertex) {
    NetVertex& w = vertices[at(v)];
    const auto end = w.triangles.begin() + w.valence;
    std::remove(w.triangles.begin(), end, triangle);
    w.used = --w.valence > 0;
  }
  triangles[at(triangle)].island = -1;
  centers_[at(triangle)] = kNowhere;
  free_triangles_.push_back(triangle);
  --size_;
}

void LatticeNet::fit(int triangle) {
  NetTriangle& t = triangles[at(triangle)];
  t.corner_cut_mm = corner_cut_mm;
  t.rigid =
      fit_rigid({vertices[at(t.vertex[0])].point, vertices[at(t.vertex[1])].point, vertices[at(t.vertex[2])].point});
  t.center = (t.rigid[0] + t.rigid[1] + t.rigid[2]) / 3.0;
  t.normal = (t.rigid[1] - t.rigid[0]).cross(t.rigid[2] - t.rigid[0]) / (kSide_mm * kHeight_mm);
  centers_[at(triangle)] = t.center;
}

void LatticeNet::near(const Vec3& place, double radius_mm, std::vector<int>& found) const {
  for (std::size_t t = 0; t < centers_.size(); ++t) {
    if ((centers_[t] - place).squaredNorm() < radius_mm * radius_mm) found.push_back(static_cast<int>(t));
  }
}

std::uint64_t LatticeNet::signature(const Vec3& place, double radius_mm) const {
  constexpr double kCell_mm = 0.2;
  std::uint64_t sum = 0;
  for (std::size_t t = 0; t < centers_.size(); ++t) {
    const Vec3& c = centers_[t];
    if ((c - place).squaredNorm() >= radius_mm * radius_mm) continue;
    std::uint64_t h = t + 1;
    for (int k = 0; k < 3; ++k)
      h = (h ^ static_cast<std::uint64_t>(std::llround(c[k] / kCell_mm))) * 0x9E3779B97F4A7C15ULL;
    sum += h ^ (h >> 29);  // in any order
  }
  return sum;
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
  std::vector<int> rest(vertices[at(vertex)].triangles.begin(),
                        vertices[at(vertex)].triangles.begin() + vertices[at(vertex)].valence);
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
