// SPDX-License-Identifier: GPL-3.0-or-later
#include "net.hpp"

#include <algorithm>
#include <cmath>

namespace triskin::lattice {
namespace {

const Vec3 kNowhere = Vec3::Constant(1e12);
constexpr double kCell_mm = 40.0;  // Most searches reach 20 … 45 mm.

}  // namespace

LatticeMesh::LatticeMesh(const std::vector<Vec3>& around, double corner_cut_mm)
    : corner_cut_mm_(corner_cut_mm), grid_(around, kCell_mm) {}

NetVertex& LatticeMesh::edit_vertex(int vertex) {
  if (is_recording_ && at(vertex) < vertices_before_ && vertex_saved_in_[at(vertex)] != recording_) {
    vertex_saved_in_[at(vertex)] = recording_;
    old_vertices_.emplace_back(vertex, vertices_[at(vertex)]);
  }
  return vertices_[at(vertex)];
}

// Must be called before every change of a triangle.
void LatticeMesh::touch(int triangle) {
  if (!is_recording_ || at(triangle) >= triangles_before_ || triangle_saved_in_[at(triangle)] == recording_) return;
  triangle_saved_in_[at(triangle)] = recording_;
  old_triangles_.emplace_back(triangle, triangles_[at(triangle)]);
}

int LatticeMesh::islands() const {
  return static_cast<int>(std::ranges::count_if(island_size_, [](int size) { return size > 0; }));
}

int LatticeMesh::new_island() {
  const int free = free_islands_.pop([&](int k) { return island_size_[at(k)] == 0; });
  if (free >= 0) return free;
  island_size_.push_back(0);
  return static_cast<int>(island_size_.size()) - 1;
}

int LatticeMesh::tile_bucket(int island, const Tile& tile) const {
  std::uint64_t h = static_cast<std::uint32_t>(island);
  for (const int part : {tile.i, tile.j, tile.up ? 1 : 0})
    h = (h ^ static_cast<std::uint32_t>(part)) * 0x9E3779B97F4A7C15ULL;
  return static_cast<int>((h ^ (h >> 32)) & static_cast<std::uint64_t>(tiles_.count() - 1));
}

bool LatticeMesh::has_tile(int island, const Tile& tile) const {
  for (int t = tiles_.first(tile_bucket(island, tile)); t >= 0; t = tiles_.next(t)) {
    if (triangles_[at(t)].island == island && triangles_[at(t)].tile == tile) return true;
  }
  return false;
}

// The number of buckets doubles, because it must be a power of two.
void LatticeMesh::grow_tiles() {
  tiles_ = Buckets(2 * tiles_.count());
  for (int t = 0; t < static_cast<int>(triangles_.size()); ++t) {
    if (grid_.holds(t)) tiles_.add(t, tile_bucket(triangles_[at(t)].island, triangles_[at(t)].tile));
  }
}

void LatticeMesh::index(int triangle) {
  const NetTriangle& t = triangles_[at(triangle)];
  centers_[at(triangle)] = t.center;
  grid_.add(triangle, t.center);
  tiles_.add(triangle, tile_bucket(t.island, t.tile));
  ++island_size_[at(t.island)];
}

void LatticeMesh::remove_from_index(int triangle) {
  centers_[at(triangle)] = kNowhere;
  grid_.remove(triangle);
  tiles_.remove(triangle);
  const int island = triangles_[at(triangle)].island;
  if (--island_size_[at(island)] == 0) free_islands_.push(island);
}

void LatticeMesh::mark_changed(int triangle) {
  if (is_changed_.size() < triangles_.size()) is_changed_.resize(triangles_.size(), 0);
  if (is_changed_[at(triangle)]) return;
  is_changed_[at(triangle)] = 1;
  changed_.push_back(triangle);
}

void LatticeMesh::mark_with_neighbours(int triangle) {
  mark_changed(triangle);
  for (int s = 0; s < 3; ++s) {
    if (const int n = neighbour(triangle, s); n >= 0) mark_changed(n);
  }
}

void LatticeMesh::take_changed(std::vector<int>& changed) {
  changed.clear();
  for (const int t : changed_) {
    is_changed_[at(t)] = 0;
    changed.push_back(t);
  }
  changed_.clear();
}

int LatticeMesh::neighbour(int triangle, int side) const {
  const auto& v = triangles_[at(triangle)].vertex;
  const NetVertex& a = vertices_[at(v[at(side)])];
  const int b = v[at((side + 1) % 3)];
  for (int k = 0; k < a.valence; ++k) {
    const int other = a.triangles[at(k)];
    if (other == triangle) continue;
    const auto& w = triangles_[at(other)].vertex;
    if (w[0] == b || w[1] == b || w[2] == b) return other;
  }
  return -1;
}

bool LatticeMesh::joined(int a, int b) const {
  const auto &v = triangles_[at(a)].vertex, &w = triangles_[at(b)].vertex;
  const auto has = [&w](int corner) { return w[0] == corner || w[1] == corner || w[2] == corner ? 1 : 0; };
  return has(v[0]) + has(v[1]) + has(v[2]) >= 2;
}

bool LatticeMesh::in_fan(int a, int b) const {
  const auto &v = triangles_[at(a)].vertex, &w = triangles_[at(b)].vertex;
  for (const int corner : v) {
    if (w[0] != corner && w[1] != corner && w[2] != corner) continue;
    const NetVertex& shared = vertices_[at(corner)];
    for (int k = 0; k < shared.valence; ++k) {
      const int t = shared.triangles[at(k)];
      if (t != a && t != b && joined(t, a) && joined(t, b)) return true;
    }
  }
  return false;
}

int LatticeMesh::add_vertex(const Vec3& point, const Vec3& normal, int i, int j) {
  int vertex = free_vertices_.pop([&](int v) { return at(v) < vertices_.size() && !vertices_[at(v)].used; });
  if (vertex < 0) {
    vertex = static_cast<int>(vertices_.size());
    vertices_.emplace_back();
  }
  NetVertex v;
  v.point = point;
  v.normal = normal;
  v.i = i;
  v.j = j;
  v.used = true;
  edit_vertex(vertex) = v;
  return vertex;
}

// Takes this number, or for −1 the one that became free last; skipped numbers become free.
int LatticeMesh::take_number(int number) {
  if (number < 0 && free_triangles_.empty()) number = static_cast<int>(triangles_.size());
  if (number < 0) number = free_triangles_.back();
  while (static_cast<int>(triangles_.size()) <= number) {
    free_triangles_.push_back(static_cast<int>(triangles_.size()));
    triangles_.emplace_back();
    centers_.push_back(kNowhere);
  }
  if (free_triangles_.back() == number)
    free_triangles_.pop_back();
  else
    std::erase(free_triangles_, number);
  return number;
}

int LatticeMesh::add_triangle(int island, const Tile& tile, const std::array<int, 3>& vertex, int number) {
  const int triangle = take_number(number);
  if (static_cast<int>(triangles_.size()) > tiles_.count()) grow_tiles();
  touch(triangle);
  NetTriangle& t = triangles_[at(triangle)];
  t.corner_cut_mm = corner_cut_mm_;
  t.vertex = vertex;
  t.tile = tile;
  t.island = island;
  for (const int v : vertex) {
    NetVertex& w = edit_vertex(v);
    w.triangles[at(w.valence++)] = triangle;
    loose_vertices_.push_back(v);
  }
  ++size_;
  index(triangle);
  fit(triangle);
  for (int s = 0; s < 3; ++s) joints_ += neighbour(triangle, s) >= 0 ? 1 : 0;
  mark_with_neighbours(triangle);
  return triangle;
}

void LatticeMesh::remove_triangle(int triangle) {
  for (int s = 0; s < 3; ++s) {
    if (const int n = neighbour(triangle, s); n >= 0) beside_removed_.push_back(n);
  }
  take_back(triangle);
}

void LatticeMesh::take_back(int triangle) {
  mark_with_neighbours(triangle);
  for (int s = 0; s < 3; ++s) joints_ -= neighbour(triangle, s) >= 0 ? 1 : 0;
  remove_from_index(triangle);
  touch(triangle);
  for (const int v : triangles_[at(triangle)].vertex) {
    NetVertex& w = edit_vertex(v);
    const auto end = w.triangles.begin() + w.valence;
    std::remove(w.triangles.begin(), end, triangle);
    w.used = --w.valence > 0;
    if (!w.used) free_vertices_.push(v);
    loose_vertices_.push_back(v);
  }
  triangles_[at(triangle)].island = -1;
  free_triangles_.push_back(triangle);
  --size_;
}

void LatticeMesh::pin(int triangle, const Triangle& corners) {
  set_rigid(triangle, corners);
  note_moved(triangle);
  triangles_[at(triangle)].is_fixed = true;
  for (const int v : triangles_[at(triangle)].vertex) edit_vertex(v).is_fixed = true;
}

void LatticeMesh::unpin(int triangle) {
  triangles_[at(triangle)].is_fixed = false;
  for (const int v : triangles_[at(triangle)].vertex) {
    NetVertex& w = edit_vertex(v);
    const auto end = w.triangles.begin() + w.valence;
    w.is_fixed = std::any_of(w.triangles.begin(), end, [&](int t) { return triangles_[at(t)].is_fixed; });
  }
}

void LatticeMesh::fit(int triangle) {
  if (triangles_[at(triangle)].is_fixed) return;
  fit_for_now(triangle);
  note_moved(triangle);
}

void LatticeMesh::fit_for_now(int triangle) {
  const NetTriangle& t = triangles_[at(triangle)];
  if (t.is_fixed) return;
  set_rigid(triangle, fit_rigid({vertices_[at(t.vertex[0])].point, vertices_[at(t.vertex[1])].point,
                                 vertices_[at(t.vertex[2])].point}));
}

void LatticeMesh::set_rigid(int triangle, const Triangle& corners) {
  touch(triangle);
  NetTriangle& t = triangles_[at(triangle)];
  t.rigid = corners;
  t.center = (t.rigid[0] + t.rigid[1] + t.rigid[2]) / 3.0;
  t.normal = (t.rigid[1] - t.rigid[0]).cross(t.rigid[2] - t.rigid[0]) / (kSide_mm * kHeight_mm);
}

void LatticeMesh::set_back(int triangle, const ModuleShape& shape) {
  static_cast<ModuleShape&>(triangles_[at(triangle)]) = shape;
}

void LatticeMesh::note_moved(int triangle) {
  const Vec3& center = triangles_[at(triangle)].center;
  centers_[at(triangle)] = center;
  grid_.move(triangle, center);
  mark_changed(triangle);
}

void LatticeMesh::near(const Vec3& place, double radius_mm, std::vector<int>& found) const {
  const auto before = static_cast<std::ptrdiff_t>(found.size());
  (void)any_near(place, radius_mm, [&](int t) {
    found.push_back(t);
    return false;
  });
  std::sort(found.begin() + before, found.end());
}

std::uint64_t LatticeMesh::signature(const Vec3& place, double radius_mm) const {
  constexpr double kStep_mm = 0.2;
  std::uint64_t sum = 0;
  (void)any_near(place, radius_mm, [&](int t) {
    std::uint64_t h = 1;
    for (int k = 0; k < 3; ++k)
      h = (h ^ static_cast<std::uint64_t>(std::llround(centers_[at(t)][k] / kStep_mm))) * 0x9E3779B97F4A7C15ULL;
    sum += h ^ (h >> 29);  // The sum does not depend on the order of the triangles.
    return false;
  });
  return sum;
}

void LatticeMesh::begin() {
  is_recording_ = true;
  ++recording_;
  vertices_before_ = vertices_.size();
  triangles_before_ = triangles_.size();
  vertex_saved_in_.resize(vertices_before_, 0);
  triangle_saved_in_.resize(triangles_before_, 0);
  old_vertices_.clear();
  old_triangles_.clear();
  free_before_ = free_triangles_;
  size_before_ = size_;
  joints_before_ = joints_;
}

void LatticeMesh::roll_back() {
  is_recording_ = false;
  std::vector<int> touched;
  for (const auto& [t, old] : old_triangles_) touched.push_back(t);
  for (int t = static_cast<int>(triangles_before_); t < static_cast<int>(triangles_.size()); ++t) touched.push_back(t);
  for (const int t : touched) {
    if (!used(t)) continue;
    mark_with_neighbours(t);
    remove_from_index(t);
  }
  for (const auto& [v, old] : old_vertices_) {
    vertices_[at(v)] = old;
    if (!old.used) free_vertices_.push(v);
  }
  vertices_.resize(vertices_before_);
  for (const auto& [t, old] : old_triangles_) {
    triangles_[at(t)] = old;
    if (used(t)) index(t);
  }
  triangles_.resize(triangles_before_);
  centers_.resize(triangles_before_);
  for (const auto& [t, old] : old_triangles_) {
    if (used(t)) mark_with_neighbours(t);
  }
  free_triangles_ = free_before_;
  size_ = size_before_;
  joints_ = joints_before_;
  loose_vertices_.clear();
  beside_removed_.clear();
}

}  // namespace triskin::lattice
