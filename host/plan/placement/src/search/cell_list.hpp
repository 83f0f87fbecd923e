// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstdint>
#include <memory>
#include <vector>

#include "kernels/pair_kernel.hpp"
#include "search/lookahead.hpp"

namespace triskin::placement {

/// Lists the undecided tiles of a cell with the edges that may still cut them. The children share the list and filter
/// it.
struct CellList {
  std::vector<OpenTile> tiles;
  std::vector<Pair> pairs;
  void clear() {
    tiles.clear();
    pairs.clear();
  }
  /// Appends a tile of another list with its edges.
  void add(const CellList& from, std::size_t number);
};

/// The tiles of a list in a seventh of its memory: edges are looked up and centres computed anew when the cell is
/// opened.
class PackedTiles {
 public:
  explicit PackedTiles(const CellList& list);
  [[nodiscard]] std::shared_ptr<const CellList> unpacked(const TileGrid& grid) const;
  [[nodiscard]] std::size_t bytes() const { return tiles_.capacity() * sizeof(PackedTile); }

 private:
  struct PackedTile {
    std::int32_t i, row;  // The row is 4 j + 2 (up) + 1 (inside): a polygon has fewer than 10⁵ rows.
  };
  std::vector<PackedTile> tiles_;
};

/// Gives each open tile a box of offsets from the cell's centre, per axis, outside which it cannot hold.
struct OffsetBoxes {
  std::array<std::vector<double>, 3> low, high;
  void clear() {
    for (auto& v : low) v.clear();
    for (auto& v : high) v.clear();
  }
};

/// Filters the undecided tiles of a cell: each becomes certain, impossible, or stays open with fewer edges. Keeps its
/// memory, so each thread needs its own object.
class CellFilter {
 public:
  CellFilter(const PreparedPolygon& polygon, const TileGrid& grid) : polygon_(polygon), grid_(grid) {}

  struct Outcome {
    int certain = 0;         ///< This many of the undecided tiles hold in the whole cell.
    int free_at_center = 0;  ///< This many of the tiles that are still undecided hold at the centre.
    /// False means that fewer than `least` tiles can hold; the other fields are then incomplete.
    bool alive = false;
  };
  /// Moves tiles of `from` that stay undecided to `kept` and `boxes`, and their constraints inside the cell to
  /// `halves`. Ends early when fewer than `least` can hold. Adds the certain tiles themselves to `certain` if it is
  /// given.
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

}  // namespace triskin::placement
