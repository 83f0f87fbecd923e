// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <array>
#include <cstdint>
#include <utility>
#include <vector>

#include "buckets.hpp"
#include "free_numbers.hpp"
#include "point_grid.hpp"
#include "rigid.hpp"
#include "triskin/base/index.hpp"
#include "triskin/design/design_types.hpp"

namespace triskin::lattice {

using Triangle = std::array<Vec3, 3>;

/// A corner of the net, shared by all triangles joined at it. Its lattice index (i, j) counts within its island.
struct NetVertex {
  Vec3 point = Vec3::Zero();  ///< The point lies on the surface, or `lift_mm` above it.
  Vec3 normal = Vec3::UnitZ();
  double lift_mm = 0.0;
  int i = 0, j = 0;
  std::array<int, 6> triangles{};
  int valence = 0;
  bool used = false;
  bool is_fixed = false;  ///< Corners of a fixed triangle do not move.
  bool on_border = false;
  Vec3 outward = Vec3::Zero();  ///< The border was last crossed in this direction.
};

/// A shape is the position of a rigid module in space.
struct ModuleShape {
  Triangle rigid;  ///< The corners are those of the whole triangle, before the corner cut.
  Vec3 center = Vec3::Zero(), normal = Vec3::UnitZ();
};

/// One module: its corners in tile order, and the rigid module that fits them best.
struct NetTriangle : ModuleShape {
  std::array<int, 3> vertex{};
  Tile tile;
  int island = -1;  ///< −1 marks an unused entry.
  double corner_cut_mm = 0.0;
  bool is_fixed = false;  ///< The module stays where pin() put it.
  [[nodiscard]] const ModuleShape& shape() const { return *this; }
};

/// Triangles over shared vertices that unfold into isometric lattices, one lattice per island. Value type: copies are
/// independent. The cost of a change depends on what it changes, not on the size of the net: places are found by a
/// grid, tiles by a table, and a step of the search is rolled back instead of being tried on a copy.
class LatticeMesh {
 public:
  LatticeMesh() = default;
  /// The net is fast for modules in the box around `around`; others are found more slowly. `corner_cut_mm` applies to
  /// every module (design/outline.hpp).
  LatticeMesh(const std::vector<Vec3>& around, double corner_cut_mm);

  [[nodiscard]] const std::vector<NetVertex>& vertices() const { return vertices_; }
  [[nodiscard]] const std::vector<NetTriangle>& triangles() const { return triangles_; }
  /// Returns a vertex to be moved; its triangles have to be fitted afterwards.
  [[nodiscard]] NetVertex& edit_vertex(int vertex);
  [[nodiscard]] double corner_cut_mm() const { return corner_cut_mm_; }

  [[nodiscard]] int size() const { return size_; }
  [[nodiscard]] bool used(int triangle) const { return triangles_[at(triangle)].island >= 0; }
  [[nodiscard]] int islands() const;
  /// Returns the size of each island; 0 marks an unused number.
  [[nodiscard]] const std::vector<int>& island_sizes() const { return island_size_; }
  [[nodiscard]] int joints() const { return joints_; }
  /// Returns a number that no island has.
  [[nodiscard]] int new_island();
  [[nodiscard]] bool has_tile(int island, const Tile& tile) const;
  /// Appends the triangles whose centre lies within a radius, in order of their indices.
  void near(const Vec3& place, double radius_mm, std::vector<int>& found) const;
  /// Calls `visit(triangle)` for triangles whose centre lies within a radius, in no order, and stops with true when a
  /// call answers true.
  [[nodiscard]] bool any_near(const Vec3& place, double radius_mm, const auto& visit) const {
    return grid_.any_near(place, radius_mm, [&](int t) {
      return (centers_[at(t)] - place).squaredNorm() < radius_mm * radius_mm && visit(t);
    });
  }
  /// Returns a number that changes when a triangle whose centre lies within a radius is added, removed, or moves by
  /// about 0.2 mm.
  [[nodiscard]] std::uint64_t signature(const Vec3& place, double radius_mm) const;
  /// Returns the centre of a triangle, packed for scans; far away for unused triangles.
  [[nodiscard]] const Vec3& center(int triangle) const { return centers_[at(triangle)]; }
  /// Returns the triangle joined across a side, or -1.
  [[nodiscard]] int neighbour(int triangle, int side) const;
  [[nodiscard]] bool joined(int a, int b) const;

  /// Returns true if both are joined to a third one.
  [[nodiscard]] bool in_fan(int a, int b) const;

  int add_vertex(const Vec3& point, const Vec3& normal, int i, int j);
  /// `number` must be one that no triangle has; −1 takes any.
  int add_triangle(int island, const Tile& tile, const std::array<int, 3>& vertex, int number = -1);
  /// Turns a triangle and its vertices into a module that never moves, with these corners.
  void pin(int triangle, const Triangle& corners);
  /// Lets a pinned module move again. The shape stays; vertices stay fixed if another pinned module has them.
  void unpin(int triangle);
  void remove_triangle(int triangle);
  /// Removes a triangle that was just added, without which its island stays connected.
  void take_back(int triangle);
  /// Fits the rigid module of a triangle to its vertices; a fixed one stays.
  void fit(int triangle);
  /// Does the same for a module that will soon be fitted again: searches find it at its old place until note_moved().
  void fit_for_now(int triangle);
  /// Restores the module that a triangle had before fit_for_now().
  void set_back(int triangle, const ModuleShape& shape);
  /// Call it after fit_for_now(), so that searches find the module at its new place and it counts as changed.
  void note_moved(int triangle);
  /// Gives parts that share only a corner, or nothing, their own corners and islands after changes. Cost: linear in the
  /// changes since the last call, and in the smaller parts of an island that falls apart.
  void separate();

  /// Starts a transaction: later changes can be undone. The net must be separated.
  void begin();
  /// Keeps the changes since begin().
  void commit() { is_recording_ = false; }
  /// Restores the net as it was at begin().
  void roll_back();

  /// Returns, each once, the triangles that were added, removed or moved, or that gained or lost a joint since the last
  /// call, including changes that were rolled back. Some may no longer exist: numbers ≥ triangles().size().
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
  Buckets tiles_{64};  // Triangles are found by a hash of island and tile.
  std::vector<int> island_size_;
  FreeNumbers free_vertices_, free_islands_;
  std::vector<int> loose_vertices_;  // The triangles of these vertices changed since separate().
  std::vector<int> beside_removed_;  // These triangles lost a joint since separate().
  std::vector<int> changed_;
  std::vector<char> is_changed_;
  std::vector<int> search_of_;  // part_island() uses this; all entries are −1 outside it.

  // While recording, the net keeps the state as of begin() of everything that changes.
  bool is_recording_ = false;
  std::uint32_t recording_ = 0;
  std::vector<std::uint32_t> vertex_saved_in_, triangle_saved_in_;
  std::vector<std::pair<int, NetVertex>> old_vertices_;
  std::vector<std::pair<int, NetTriangle>> old_triangles_;
  std::size_t vertices_before_ = 0, triangles_before_ = 0;
  std::vector<int> free_before_;
  int size_before_ = 0, joints_before_ = 0;
};

/// A point over a module lies within this distance of its centre: 2h/3 = 17.3 mm along it, and its height.
inline constexpr double kModuleReach_mm = 20.0;
/// Returns true if a point lies over the whole triangle of a module, seen along its normal, at whatever height.
[[nodiscard]] inline bool lies_over(const NetTriangle& t, const Vec3& p) {
  for (std::size_t k = 0; k < 3; ++k) {
    if (t.normal.cross(t.rigid[(k + 1) % 3] - t.rigid[k]).dot(p - t.rigid[k]) < 0) return false;
  }
  return true;
}

}  // namespace triskin::lattice
