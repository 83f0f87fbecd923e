// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <vector>

#include "kernels/edge_figures.hpp"
#include "kernels/sample_bits.hpp"
#include "search/cell_list.hpp"

namespace triskin::placement {

/// Bounds all translations of one lattice period at a small range of angles, divided into 16 × 16 parts. The centres
/// of all tiles at the middles of all parts sample the plane regularly, so one scan of the polygon decides for every
/// tile in every part whether it may hold and whether it must. The centres of the tiles that an edge cuts fill a convex
/// polygon with one half plane per direction: shrunk by the motion inside a part they are surely cut, grown by it
/// perhaps. Keeps its memory, so each thread needs its own object.
class SliceRaster {
 public:
  static constexpr int kSteps = SampleBits::kBlock;
  static constexpr auto kFull = static_cast<std::uint32_t>((std::uint64_t{1} << kSteps) - 1);
  /// An outline of a million modules fits into a raster of 100 MB; the raster of a needle of 100 m takes 1.2 GB. A
  /// slice whose raster would take more than this stays open.
  static constexpr double kMaxBytes = 128e6;
  using Rows = std::array<std::uint32_t, kSteps>;  ///< A row is a part in y, and each of its bits a part in x.

  /// A border tile does not behave the same in all parts.
  struct Border {
    Tile tile;
    Rows may, must;
  };

  SliceRaster(const PreparedPolygon& polygon, const TileGrid& grid) : polygon_(polygon), grid_(grid), edges_(polygon) {}

  /// Returns the memory that scan() and collect() of this frame take. It grows with the box around the moved polygon,
  /// so a needle on the slant takes most.
  [[nodiscard]] double bytes_for(const CellFrame& frame) {
    set_window(frame);
    return static_cast<double>(sizeof(std::uint32_t)) * words_ * rows_ * static_cast<double>(kLayers) * grid_.kinds;
  }
  /// `frame` belongs to the slice, which has all translations of one lattice period. Counts the tiles that may hold in
  /// each part; a bound needs no more.
  void scan(const CellFrame& frame);
  /// Finds, after scan() of the same frame, the tiles that hold in all parts and those that differ between parts.
  void collect(const CellFrame& frame);

  /// Returns the number of tiles that hold in all parts; 0 before collect().
  [[nodiscard]] int certain() const { return static_cast<int>(certain_.size()); }
  [[nodiscard]] const std::vector<Tile>& certain_tiles() const { return certain_; }
  [[nodiscard]] const std::vector<Border>& border() const { return border_; }
  /// Returns the number of tiles that may hold somewhere in the part, without those of certain().
  [[nodiscard]] int count(int x, int y) const {
    return counts_[static_cast<std::size_t>(x)][static_cast<std::size_t>(y)] - certain();
  }

 private:
  enum Layer : std::size_t { kInside, kCut, kTouched, kLayers };
  struct Kind {
    FigureTerms terms;
    std::array<SampleBits, kLayers> bits;
  };
  void set_window(const CellFrame& frame);
  void set_terms(const CellFrame& frame, bool up, FigureTerms& to) const;
  void scan_inside(const CellFrame& frame, Kind& kind);
  void collect_kind(bool up);
  static void take_rows(const SampleBits& bits, int row, int column, BlockWords& to);
  void collect_tile(const Tile& tile, const Kind& kind, int row, int column);

  const PreparedPolygon& polygon_;
  const TileGrid& grid_;
  // Sample n of a row lies to the left of sample n − 1, because translations to the right move the tile to the left.
  // Tile (0, 0) begins with a block of words, and so does every row of tiles.
  int first_column_ = 0, first_row_ = 0, shift_steps_ = 0, words_ = 0, rows_ = 0;
  double step_x_ = 0.0, step_y_ = 0.0;
  EdgeArrays edges_;
  std::array<Kind, 2> kinds_;
  std::vector<int> row_of_;  // Each vertex has the first row of samples that is not above it.
  std::vector<Border> border_;
  std::vector<Tile> certain_;
  std::array<BitCounts, 2> sums_;  // The first sum is for even rows of tiles, the second for odd ones.
  BitCounts::Counts counts_{};     // The counts are indexed by x, then y.
};

}  // namespace triskin::placement
