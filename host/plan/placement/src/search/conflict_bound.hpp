// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "kernels/pair_kernel.hpp"
#include "search/cell_list.hpp"
#include "search/joint_program.hpp"

namespace triskin::placement {

/// Bounds a cell by constraints that contradict each other, although each of them alone can hold: a tile between two
/// parallel edges that are slightly too close, or two tiles of which one needs the lower and the other the upper edge.
///
/// With w = R(-phi) * (t - centre) and sigma = sin(phi), phi the turn from the centre of the cell, a constraint between
/// a point of a tile and the line of an edge is linear in w and sigma but for 1 - cos(phi). If the normals of two or
/// three constraints cancel, their weighted sum depends on the angle alone, whatever the translations of the cell, so
/// no box needs to be small along the free direction. Where pairs are not enough, linear programs find groups of tiles
/// that exclude each other, and cores of up to four tiles of which one is left out (docs/placement.md). Keeps
/// its memory, so each thread needs its own object.
class ConflictBound {
 public:
  ConflictBound(const PreparedPolygon& polygon, const TileGrid& grid) : polygon_(polygon), grid_(grid) {}

  enum class Verdict {
    kOpen,      ///< The constraints do not contradict each other enough.
    kNarrower,  ///< They would contradict each other in a cell with a smaller range of angles.
    kClosed     ///< Fewer than `need` tiles hold anywhere in the cell.
  };
  /// Tells whether `need` of the tiles of `list` can hold at one motion of the cell. Cost: O(n log n) for n pairs of
  /// tile and edge, and the square of the number of edges that have opposed ones.
  Verdict judge(const CellFrame& frame, const CellList& list, int need);
  /// Returns one entry per tile of the last list: not 0 if the tile holds nowhere in the cell.
  [[nodiscard]] const std::vector<std::uint8_t>& dead() const { return dead_; }
  /// Returns false if the last cell had so few contradictions that its children are unlikely to be closed by them.
  [[nodiscard]] bool is_promising() const { return is_promising_; }

 private:
  /// The constraint level - normal.w + slope * sigma >= 0, up to `soft`, which vanishes with the range of angles.
  struct Row {
    std::uint32_t tile = 0, edge = 0;
    bool by_side = false;  // The point is an end of the edge, and the translation turns against the side's normal.
    Vec2 normal;
    double level = 0.0, slope = 0.0, soft = 0.0;
  };
  struct Interval {
    double low = 0.0, high = 0.0;
  };
  /// The rows [first, last) of one tile at one edge, all with the same normal.
  struct Needs {
    bool by_side = false;
    std::uint32_t edge = 0;
    Vec2 normal;
    double along = 0.0;  // The place of the tile's centre along the edge, to the left of the normal.
    std::uint32_t tile = 0, first = 0, last = 0;
    double least = 0.0;  // No row has a lower level.
    [[nodiscard]] bool at_same_edge(const Needs& other) const {
      return by_side == other.by_side && edge == other.edge && normal == other.normal;
    }
  };
  void set_cell(const CellFrame& frame, const CellList& list);
  void collect(const CellFrame& frame, const CellList& list);
  void collect_pair(const CellFrame& frame, const OpenTile& tile, const Pair& pair, std::size_t lane);
  void add_line(const CellFrame& frame, const Pair& pair, double turn, const Vec2& point, double min_mm);
  void add_side(const CellFrame& frame, const OpenTile& tile, const Pair& pair, std::size_t side);
  void add_points_over_edge(const CellFrame& frame, const OpenTile& tile, const Pair& pair, double min_mm);
  void keep(const Row& row);
  [[nodiscard]] static bool opposed(const auto& a, const auto& b) {
    return a.by_side == b.by_side && a.edge != b.edge && a.normal.dot(b.normal) <= kOpposed;
  }
  int survivors(const CellList& list, double softness, int need);
  [[nodiscard]] bool holds_nowhere(std::size_t first, std::size_t last, double softness);
  void add_pairs_of(std::size_t first, std::size_t last, double softness);
  void add_triples_of(std::size_t first, std::size_t last, double softness);
  void add_sum(double level, double slope);
  [[nodiscard]] bool angles_covered();
  void find_conflicts(const CellList& list, double softness);
  void collect_needs(const CellList& list, double softness);
  void compare_edges(std::span<const Needs> at_one, std::span<const Needs> at_other, double softness);
  [[nodiscard]] bool exclude_each_other(const Needs& a, const Needs& b, double softness);
  [[nodiscard]] int matching(std::size_t tiles);
  bool augment(std::uint32_t tile, std::uint32_t root);
  bool pair_up(std::uint32_t tile, std::uint32_t other);
  struct BoxRow {
    std::array<double, 3> gradient{};
    double level = 0.0;
  };
  /// A tile with rows [first, last) at two opposed edges, and its place along them.
  struct Contested {
    std::uint32_t tile = 0, first = 0, last = 0;
    double along = 0.0;
  };
  [[nodiscard]] int saved_by_cliques(const CellList& list, double softness);
  void find_contested(const CellList& list);
  [[nodiscard]] bool exclude_jointly(const Contested& a, const Contested& b, double softness);
  void add_to_program(const Row& row, double softness);
  [[nodiscard]] bool contradict_each_other(double softness, int drops, int pairs);
  [[nodiscard]] std::array<BoxRow, 4> box_rows(double softness) const;

  static constexpr double kOpposed = -0.999;  // Two normals with a smaller cosine count as opposed.

  const PreparedPolygon& polygon_;
  const TileGrid& grid_;
  PairBlock block_;
  // The mean of the tiles' centres, relative to the centre of the cell, keeps 1 - cos(phi) times its arm small.
  Vec2 pivot_;
  // These bound sin φ, 1 − cos φ, the translation and w.
  double sigma_ = 0.0, curve_ = 0.0, slide_ = 0.0, shift_ = 0.0;
  std::array<double, 2> half_{};
  std::vector<Row> rows_;  // Rows of one tile are consecutive.
  std::vector<std::uint8_t> dead_;
  bool is_promising_ = true;
  std::vector<Interval> excluded_;  // These intervals of sigma are excluded.
  std::vector<Needs> needs_;
  std::vector<std::vector<std::uint32_t>> conflicts_;  // Each tile lists the tiles with which it cannot hold.
  std::vector<std::int32_t> side_, mate_;
  std::vector<std::uint32_t> asked_for_;  // The last root that asked for the tile, plus one.
  std::vector<Contested> contested_;
  std::vector<std::int32_t> contested_at_;         // Where `contested_` has each tile, or −1.
  std::vector<std::vector<std::size_t>> cliques_;  // Indices into `contested_`.
  JointProgram program_;
};

}  // namespace triskin::placement
