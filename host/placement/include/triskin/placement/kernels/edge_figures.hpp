// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <vector>

#include "triskin/placement/kernels/pair_kernel.hpp"
#include "triskin/placement/kernels/sample_bits.hpp"

namespace triskin::geometry {

/// Edges of a moved polygon side by side, a multiple of eight: the last one stands again to the end.
struct EdgeArrays {
  static constexpr std::size_t kLanes = 8;
  std::vector<double> ax, ay, bx, by, normal_x, normal_y;
  std::vector<double> offset, far;  ///< They are the offset of the line and the largest distance from the pivot.
  std::size_t count = 0;            ///< Repeated edges are not counted.

  explicit EdgeArrays(const PreparedPolygon& polygon);
  void move(const PreparedPolygon& polygon, const CellFrame& frame);
};

/// Sampled positions of the centres of one kind of tiles, and the relative motion of edge and tile.
struct FigureTerms {
  double sign = 1.0;                 ///< It is +1 for up tiles and −1 for down tiles.
  double column0 = 0.0, row0 = 0.0;  ///< A point has the column column0 − x/step_x and the row row0 − y/step_y.
  double step_x = 0.0, step_y = 0.0;
  double half_x = 0.0, half_y = 0.0, turn = 0.0;  ///< They are the largest shift and turn.
  double separation_mm = 0.0;                     ///< An edge at this separation or more leaves the tile alone.
};

/// Switches on the samples of the centres of the tiles that an edge cuts. They fill a convex figure for each edge, one
/// half plane a direction. `outer`: at some motion, and a few samples more; else at every motion, and a few less.
void fill_figures(const EdgeArrays& edges, const TileGrid& grid, const FigureTerms& terms, bool outer,
                  SampleBits& bits);

}  // namespace triskin::geometry
