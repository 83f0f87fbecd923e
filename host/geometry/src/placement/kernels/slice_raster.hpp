// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <vector>

#include "placement/kernels/row_spans.hpp"
#include "placement/search/cell_list.hpp"

namespace triskin::geometry {

/// All translations of one lattice period at a small range of angles, cut into 16 × 16 parts. The centres of all tiles
/// at the middles of all parts sample the plane regularly: one scan of the polygon decides for every tile in every part
/// whether it may hold and whether it must. The centres of the tiles that an edge cuts fill a convex polygon, one half
/// plane a direction: shrunk by what moves inside a part they are surely cut, grown by it perhaps. Keeps its memory:
/// one object a thread.
class SliceRaster {
 public:
  static constexpr int kSteps = 16;
  static constexpr auto kFull = static_cast<std::uint32_t>((std::uint64_t{1} << kSteps) - 1);
  using Rows = std::array<std::uint32_t, kSteps>;  ///< row: part in y; bit: part in x

  /// A tile that does not do the same in all parts.
  struct Border {
    Tile tile;
    Rows may, must;
  };

  SliceRaster(const PreparedPolygon& polygon, const TileGrid& grid) : polygon_(polygon), grid_(grid) {}

  /// `frame`: of the slice, all translations of one lattice period.
  void scan(const CellFrame& frame);

  /// Tiles that hold in all parts.
  [[nodiscard]] int certain() const { return certain_; }
  [[nodiscard]] const std::vector<Border>& border() const { return border_; }
  /// Number of border tiles that may hold somewhere in the part.
  [[nodiscard]] int count(int x, int y) const { return counts_[static_cast<std::size_t>(kSteps * y + x)]; }

 private:
  enum Layer : std::size_t { kInside, kCut, kTouched, kLayers };
  struct Kind {
    Vec2 first;  // sample 0 of tile (0, 0)
    std::array<std::vector<std::uint64_t>, kLayers> bits;
  };
  void set_window(const CellFrame& frame);
  void scan_inside(const CellFrame& frame, Kind& kind);
  void scan_edge(const CellFrame& frame, std::size_t edge, double sign, Kind& kind);
  struct HalfPlane {
    Vec2 normal;  // normal·c ≤ limit
    double limit;
  };
  void fill(const Vec2& a, const Vec2& b, const std::vector<HalfPlane>& planes, bool outer, const Kind& kind,
            std::vector<std::uint64_t>& bits);
  static void fill_row(std::uint64_t* words, std::int32_t begin, std::int32_t end);
  void collect(bool up);
  void collect_near(const Tile& tile, const Kind& kind, int row, int column);
  void add_to_counts(const Rows& may);
  [[nodiscard]] std::uint32_t bits_at(const std::vector<std::uint64_t>& bits, int row, int column) const;

  const PreparedPolygon& polygon_;
  const TileGrid& grid_;
  // Sample n of a row lies to the left of sample n − 1: translations to the right move the tile to the left.
  int first_column_ = 0, first_row_ = 0, shift_steps_ = 0, columns_ = 0, rows_ = 0;
  double step_x_ = 0.0, step_y_ = 0.0, touched_room_mm_ = 0.0;
  std::size_t words_ = 0;
  std::array<Kind, 2> kinds_;
  std::vector<HalfPlane> cut_, touched_;
  BoundLines lines_;
  std::vector<int> row_of_;  // of each vertex: the first row of samples that is not above it
  std::vector<std::int32_t> begin_, end_;
  std::vector<std::uint64_t> near_;
  std::vector<Border> border_;
  int certain_ = 0;
  std::vector<Rows> planes_;  // binary digits of the counts
  std::array<int, kSteps * kSteps> counts_{};
};

}  // namespace triskin::geometry
