// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "kernels/edge_grid.hpp"
#include "kernels/evaluator.hpp"
#include "kernels/pair_kernel.hpp"
#include "kernels/small_linear_program.hpp"

namespace triskin::placement {

/// Moves a placement of `modules` tiles to where they have the most room. Keeps its memory, so each thread needs its
/// own object.
class ClearanceAscent {
 public:
  ClearanceAscent(const PreparedPolygon& polygon, const TileGrid& grid, int modules);

  /// Returns the `n` motions with the largest clearance, at which the tiles hold with `min_mm`; no two are close
  /// together.
  std::vector<Motion> max_promising(const std::vector<Motion>& motions, std::size_t n, double min_mm);

  /// Moves `motion` to a local maximum of the inset at which `modules` tiles hold, and returns that inset; −inradius
  /// when fewer hold with `inset_mm`. Solves linear programs in trust regions: each step widens the narrowest places of
  /// the tiles that hold.
  double climb(Motion& motion, double inset_mm);

 private:
  double choose_tiles(const Motion& motion, double inset_mm);
  void list_pairs(const Motion& motion);
  double min_separation(const Motion& motion, bool collect_rows);
  void collect_rows(std::size_t pair, std::size_t lane);
  [[nodiscard]] bool step(double radius_mm, std::array<double, 4>& move);
  double counted(const Motion& motion, double reached, double least);

  const PreparedPolygon& polygon_;
  const TileGrid& grid_;
  Evaluator evaluator_;
  EdgeGrid edges_;
  std::size_t modules_;
  std::vector<OpenTile> tiles_;
  std::vector<double> separation_;
  std::vector<Pair> pairs_;
  CellFrame frame_;
  PairBlock block_;
  LinearWork<4> program_;
};

}  // namespace triskin::placement
