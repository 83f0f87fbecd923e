// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <array>
#include <cstdint>
#include <utility>
#include <vector>

#include "triskin/base/index.hpp"
#include "triskin/design/design_types.hpp"
#include "triskin/lattice/buckets.hpp"
#include "triskin/lattice/free_numbers.hpp"
#include "triskin/lattice/point_grid.hpp"

namespace triskin::geometry::surface_lattice {

using Triangle = std::array<Vec3, 3>;

/// Corner of the net, shared by all triangles joined at it. Its lattice index (i, j) counts within its island.
struct NetVertex {
  Vec3 point = Vec3::Zero();  ///< It lies on the surface, or `lift_mm` above it.
  Vec3 normal = Vec3::UnitZ();
  double lift_mm = 0.0;
  int i = 0, j = 0;
  std::array<int, 6> triangles{};
  int valence = 0;
  bool used = false;
  bool is_fixed = false;  ///< Corners of a fixed triangle do not move.
  bool on_border = false;
  Vec3 outward = Vec3::Zero();  ///< It is the direction in which the border was last crossed.
};

/// Position of a rigid module.
struct ModuleShape {
  Triangle rigid;  ///< It has the corners of the whole triangle.
  Vec3 center = Vec3::Zero(), normal = Vec3::UnitZ();
};

/// One module: corners in tile order, and the rigid module that fits them best.
struct NetTriangle : ModuleShape {
  std::array<int, 3> vertex{};
  Tile tile;
  int island = -1;  ///< It is −1 for an unused entry.
  double corner_cut_mm = 0.0;
  bool is_fixed = false;  ///< The module stays as it was given (pin).
  [[nodiscard]] const ModuleShape& shape() const { return *this; }
};

/// Triangles over shared vertices that unfold into isometric lattices, one lattice an island. Value type: copies are
/// independent. What a change costs depends on what it changes, not on the size of the net: places are found by a grid,
/// tiles by a table, and a step of the search is taken back instead of being tried on a copy.
class LatticeMesh {
 public:
  LatticeMesh() = default;
  /// The net is fast for modules in the box around `around`; others are found more slowly. `corner_cut_mm` applies to
  /// every module (design/outline.hpp).
  LatticeMesh(const std::vector<Vec3>& around, double corner_cut_mm);

  [[nodiscard]] const std::vector<NetVertex>& vertices() const { return vertices_; }
  [[nodiscard]] const std::vector<NetTriangle>& triangles() const { return triangles_; }
  /// A vertex to be moved; its triangles have to be fitted afterwards.
  [[nodiscard]] NetVertex& edit_vertex(int vertex);
  [[nodiscard]] double corner_cut_mm() const { return corner_cut_mm_; }

  [[nodiscard]] int size() const { return size_; }
  [[nodiscard]] bool used(int triangle) const { return triangles_[at(triangle)].island >= 0; }
  [[nodiscard]] int islands() const;
  /// Indexed by the number of the island; 0: a number without island.
  [[nodiscard]] const std::vector<int>& island_sizes() const { return island_size_; }
  [[nodiscard]] int joints() const { return joints_; }
  /// A number without island.
  [[nodiscard]] int new_island();
  [[nodiscard]] bool has_tile(int island, const Tile& tile) const;
  /// Appends the triangles whose centre lies within a radius, in order of their indices.
  void near(const Vec3& place, double radius_mm, std::vector<int>& found) const;
  /// Calls `visit(triangle)` for the triangles whose centre lies within a radius, in no order, until it answers true;
  /// then is true.
  [[nodiscard]] bool any_near(const Vec3& place, double radius_mm, const auto& visit) const {
    return grid_.any_near(place, radius_mm, [&](int t) {
      return (centers_[at(t)] - place).squaredNorm() < radius_mm * radius_mm && visit(t);
    });
  }
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
  /// `number`: one that no triangle has; −1: any.
  int add_triangle(int island, const Tile& tile, const std::array<int, 3>& vertex, int number = -1);
  /// Makes a triangle a module that never moves, with these corners, and its vertices too.
  void pin(int triangle, const Triangle& corners);
  /// Makes a pinned module one that moves. The shape stays; vertices stay fixed where other pinned modules have them.
  void unpin(int triangle);
  void remove_triangle(int triangle);
  /// Removes a triangle that was just added: its island hangs together without it.
  void take_back(int triangle);
  /// Fits the rigid module of a triangle to its vertices; a fixed one stays.
  void fit(int triangle);
  /// The same for a module that is about to be fitted again: searches find it where it was until note_moved().
  void fit_for_now(int triangle);
  /// Puts back the module that a triangle had before fit_for_now().
  void set_back(int triangle, const ModuleShape& shape);
  /// Call it after fit_for_now(), so that searches find the module at its new place and it counts as changed.
  void note_moved(int triangle);
  /// Gives parts that share only a corner, or nothing, their own corners and islands after changes. Cost: linear in
  /// the changes since the last call, and in the smaller parts of an island that falls apart.
  void separate();

  /// Starts a transaction: later changes can be undone. The net must be separated.
  void begin();
  /// Keeps the changes since begin().
  void commit() { is_recording_ = false; }
  /// Makes the net what it was at begin().
  void roll_back();

  /// Triangles that came, went, moved, or gained or lost a joint since this was last called, and those of changes that
  /// were taken back; each once. Some may be no longer there: numbers ≥ triangles().size().
  void take_changed(std::vector<int>& changed);

 private:
  void touch(int triangle);
  [[nodiscard]] int take_number(int number);
  void set_rigid(int triangle, const Triangle& corners);
  void index(int triangle);
  void remove_from_index(int triangle);
  void mark_changed(int triangle);
  void mark_with_neighbours(int triangle);
  [[nodiscard]] int tile_bucket(int island, const Tile& tile) const;
  void grow_tiles();
  void split_fans(int vertex);
  void part_islands();
  void part_island(const std::vector<int>& beside_removed);
  void give_island(const std::vector<int>& triangles, int island);

  double corner_cut_mm_ = 0.0;
  std::vector<NetVertex> vertices_;
  std::vector<NetTriangle> triangles_;
  int size_ = 0, joints_ = 0;
  std::vector<int> free_triangles_;
  std::vector<Vec3> centers_;
  PointGrid grid_;     // Holds the centres of the triangles.
  Buckets tiles_{64};  // Triangles, found by a hash of island and tile.
  std::vector<int> island_size_;
  FreeNumbers free_vertices_, free_islands_;
  std::vector<int> loose_vertices_;  // Vertices whose triangles changed since separate().
  std::vector<int> beside_removed_;  // Triangles that lost a joint since separate().
  std::vector<int> changed_;
  std::vector<char> is_changed_;
  std::vector<int> search_of_;  // Work of part_island(): −1 outside it.

  // Former state, as of begin(), of everything that was changed since.
  bool is_recording_ = false;
  std::uint32_t recording_ = 0;
  std::vector<std::uint32_t> vertex_saved_in_, triangle_saved_in_;
  std::vector<std::pair<int, NetVertex>> old_vertices_;
  std::vector<std::pair<int, NetTriangle>> old_triangles_;
  std::size_t vertices_before_ = 0, triangles_before_ = 0;
  std::vector<int> free_before_;
  int size_before_ = 0, joints_before_ = 0;
};

/// A point over a module lies within this of its centre: 2h/3 = 17.3 mm along it, and its height.
inline constexpr double kModuleReach_mm = 20.0;
/// True if a point lies over the whole triangle of a module, seen along its normal, at whatever height.
[[nodiscard]] inline bool lies_over(const NetTriangle& t, const Vec3& p) {
  for (std::size_t k = 0; k < 3; ++k) {
    if (t.normal.cross(t.rigid[(k + 1) % 3] - t.rigid[k]).dot(p - t.rigid[k]) < 0) return false;
  }
  return true;
}

/// The rigid module nearest to three points in the least-squares sense.
[[nodiscard]] Triangle fit_rigid(const Triangle& target);

}  // namespace triskin::geometry::surface_lattice
