// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <vector>

#include "triskin/placement/kernels/pair_kernel.hpp"
#include "triskin/placement/search/lookahead.hpp"

namespace triskin::geometry {

/// Undecided tiles of a cell with the edges that may still cut them; shared by the children, which filter it.
struct CellList {
  std::vector<OpenTile> tiles;
  std::vector<Pair> pairs;
  void clear() {
    tiles.clear();
    pairs.clear();
  }
};

/// Box of each open tile, as offsets from the cell's centre per axis: outside it the tile cannot hold.
struct OffsetBoxes {
  std::array<std::vector<double>, 3> low, high;
  void clear() {
    for (auto& v : low) v.clear();
    for (auto& v : high) v.clear();
  }
};

/// Filter of the undecided tiles of a cell: each becomes certain, impossible, or stays open with fewer edges. One
/// object a thread: it keeps its memory.
class CellFilter {
 public:
  CellFilter(const PreparedPolygon& polygon, const TileGrid& grid) : polygon_(polygon), grid_(grid) {}

  struct Outcome {
    int certain = 0;         ///< Of the tiles that were undecided, so many hold in the whole cell.
    int free_at_center = 0;  ///< Of those still undecided, so many hold at the centre.
    /// It is false when fewer than `least` tiles can hold; the other fields are then incomplete.
    bool alive = false;
  };
  /// Tiles of `from` that stay undecided go to `kept` and `boxes`. Ends early when fewer than `least` can hold.
  /// Their constraints inside the cell go to `halves`; the certain ones themselves are added to `certain`, when it
  /// is given.
  Outcome filter(const CellFrame& frame, const CellList& from, int least, CellList& kept, OffsetBoxes& boxes,
                 std::vector<HalfSpace>& halves, std::vector<OpenTile>* certain = nullptr);

 private:
  enum class Fate { kDead, kDecided, kOpen };
  struct Box {
    std::array<double, 3> low, high;
  };
  Fate evaluate_tile(const CellFrame& frame, const CellList& from, OpenTile& tile, CellList& kept, Box& box,
                     bool& free_at_center, std::vector<HalfSpace>& halves);
  void collect(const CellFrame& frame, double sign, std::uint32_t edge, std::size_t lane,
               std::vector<HalfSpace>& halves) const;
  const PairBlock& block_of(const CellFrame& frame, const CellList& from, std::size_t pair);
  [[nodiscard]] bool center_inside(const CellFrame& frame, const Vec2& center) const;

  const PreparedPolygon& polygon_;
  const TileGrid& grid_;
  PairBlock block_;
  std::size_t block_number_ = 0;
};

}  // namespace triskin::geometry
