// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <array>
#include <cstdint>
#include <vector>

#include "index.hpp"
#include "triskin/geometry/design_types.hpp"

namespace triskin::geometry::surface_lattice {

using Triangle = std::array<Vec3, 3>;

/// Corner of the net, shared by all triangles joined at it. Its lattice index (i, j) counts within its island.
struct NetVertex {
  Vec3 point = Vec3::Zero();  ///< on the surface, or `lift_mm` above it
  Vec3 normal = Vec3::UnitZ();
  double lift_mm = 0.0;
  int i = 0, j = 0;
  std::array<int, 6> triangles{};
  int valence = 0;
  bool used = false;
  bool on_border = false;
  Vec3 outward = Vec3::Zero();  ///< direction in which the border was last run over
};

/// One module: corners in tile order, and the rigid module that fits them best.
struct NetTriangle {
  std::array<int, 3> vertex{};
  Tile tile;
  int island = -1;  ///< -1: unused
  double corner_cut_mm = 0.0;
  Triangle rigid;  ///< corners of the whole triangle
  Vec3 center = Vec3::Zero(), normal = Vec3::UnitZ();
};

/// Triangles over shared vertices that unfold into isometric lattices, one lattice an island. Value type: copies are
/// independent (the search keeps several).
class LatticeNet {
 public:
  std::vector<NetVertex> vertices;
  std::vector<NetTriangle> triangles;
  double corner_cut_mm = 0.0;  ///< of every module (design/outline.hpp); set before the first one is added

  [[nodiscard]] int size() const { return size_; }
  [[nodiscard]] bool used(int triangle) const { return triangles[at(triangle)].island >= 0; }
  [[nodiscard]] int islands() const { return static_cast<int>(island_sizes().size()); }
  [[nodiscard]] std::vector<int> island_sizes() const;
  [[nodiscard]] int joints() const;
  [[nodiscard]] int new_island() { return next_island_++; }
  [[nodiscard]] bool has_tile(int island, const Tile& tile) const;
  /// Appends the triangles whose centre lies within a radius, in order of their indices.
  void near(const Vec3& place, double radius_mm, std::vector<int>& found) const;
  /// Number that changes when a triangle whose centre lies within a radius comes, goes, or moves by about 0.2 mm.
  [[nodiscard]] std::uint64_t signature(const Vec3& place, double radius_mm) const;
  /// Centre of a triangle, packed for scans; far away for unused triangles.
  [[nodiscard]] const Vec3& center(int triangle) const { return centers_[at(triangle)]; }
  /// Triangle joined across a side, or -1.
  [[nodiscard]] int neighbour(int triangle, int side) const;
  [[nodiscard]] bool joined(int a, int b) const;

  /// Both are joined to a third one.
  [[nodiscard]] bool in_fan(int a, int b) const;

  int add_vertex(const Vec3& point, const Vec3& normal, int i, int j);
  int add_triangle(int island, const Tile& tile, const std::array<int, 3>& vertex);
  void remove_triangle(int triangle);
  /// Fits the rigid module of a triangle to its vertices.
  void fit(int triangle);
  /// After removals: parts that hang together only at a corner, or not at all, get corners and islands of their own.
  void separate();

 private:
  void split_fans(int vertex);
  void renumber_islands();
  int size_ = 0, next_island_ = 0;
  std::vector<int> free_triangles_;
  std::vector<Vec3> centers_;
};

/// The rigid module nearest to three points in the least-squares sense.
[[nodiscard]] Triangle fit_rigid(const Triangle& target);

}  // namespace triskin::geometry::surface_lattice
