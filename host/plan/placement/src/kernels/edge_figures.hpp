// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <vector>

#include "kernels/pair_kernel.hpp"
#include "kernels/sample_bits.hpp"

namespace triskin::placement {

/// Stores the edges of a moved polygon as arrays whose length is a multiple of eight; the last edge is repeated to fill
/// them.
struct EdgeArrays {
  static constexpr std::size_t kLanes = 8;
  std::vector<double> ax, ay, bx, by, normal_x, normal_y;
  /// `offset` is that of the edge's line; no point of the edge is farther from the pivot than `far`.
  std::vector<double> offset, far;
  std::size_t count = 0;  ///< Repeated edges are not counted.

  explicit EdgeArrays(const PreparedPolygon& polygon);
  void move(const PreparedPolygon& polygon, const CellFrame& frame);
};

/// Places the sample positions for the centres of one kind of tile, and bounds the relative motion of edge and tile.
struct FigureTerms {
  double sign = 1.0;                 ///< +1 stands for up tiles and −1 for down tiles.
  double column0 = 0.0, row0 = 0.0;  ///< A point has the column column0 − x/step_x and the row row0 − y/step_y.
  double step_x = 0.0, step_y = 0.0;
  /// No motion shifts by more than half_x, half_y or turns by more than `turn`.
  double half_x = 0.0, half_y = 0.0, turn = 0.0;
  double separation_mm = 0.0;  ///< An edge that is at least this far away does not affect the tile.
};

/// Sets the samples at the centres of the tiles that an edge cuts. They fill a convex figure for each edge, bounded by
/// one half plane per direction. With `outer` the figure has every tile that is cut at some motion, and a few samples
/// more; otherwise the tiles cut at every motion, and a few samples less.
void fill_figures(const EdgeArrays& edges, const TileGrid& grid, const FigureTerms& terms, bool outer,
                  SampleBits& bits);

}  // namespace triskin::placement
