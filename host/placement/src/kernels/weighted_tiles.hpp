// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "search/objective_search.hpp"
#include "triskin/placement/weight_map.hpp"

namespace triskin::geometry {

/// Sums the weights at the centres of the tiles. The certain tiles are bounded as one function of the motion, to first
/// order with the curvature of the map: near the optimum their slopes cancel, which single bounds would not see.
class WeightedTiles final : public Objective {
 public:
  WeightedTiles(const PreparedPolygon& polygon, const TileGrid& grid, const WeightMap& map)
      : polygon_(polygon), grid_(grid), map_(map) {}
  double value(const Motion& motion, const std::vector<Tile>& inside) override;
  double bound(const CellFrame& cell, const std::vector<OpenTile>& certain, const std::vector<OpenTile>& open) override;
  [[nodiscard]] int needed(double value) const override;
  [[nodiscard]] double slack(double value) const override { return kPrecision * value; }

  static constexpr double kPrecision = 1e-5;  ///< The search ends at this relative gap.

 private:
  struct Term {
    double value;
    std::array<double, 3> slope;  // The slopes are along x, y and theta.
    double rest;                  // The first-order term is off by at most this in the cell.
  };
  [[nodiscard]] Term term(const CellFrame& cell, const Vec2& center) const;

  const PreparedPolygon& polygon_;
  const TileGrid& grid_;
  const WeightMap& map_;
  double certain_ = 0.0;
  std::vector<double> open_;
};

}  // namespace triskin::geometry
